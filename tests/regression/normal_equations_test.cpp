#include "vernier/regression/detail/normal_equations.hpp"

#include <gtest/gtest.h>

#include "instruction_sets.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::normal_equations_test {
namespace {

MatrixX uniform(Index rows, Index columns, double limit, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, columns);
  for (auto& x : out.reshaped()) x = rng.uniform(-limit, limit);
  return out;
}

TEST(Sigmoid, EqualsTheLibraryFunction) {
  for (double z = -760; z < 760; z += 0.37) {
    typename detail::Simd<2>::Double v{z, -z};
    detail::sigmoid<2>(v);
    const double expected = 1 / (1 + std::exp(-z));
    EXPECT_NEAR(v[0], expected, 4e-15 * expected + 1e-300) << z;
    EXPECT_NEAR(v[1], 1 / (1 + std::exp(z)), 4e-15 / (1 + std::exp(z)) + 1e-300) << z;
  }
}

/// Products to 1e-12; tanh, as 2 sigmoid(2 z) - 1, to 1e-15 absolute. Sizes that leave remainders everywhere: samples
/// and the tile, nodes and the vector, inputs, outputs.
TEST(NormalEquations, EqualThePlainProductsOnEveryInstructionSet) {
  for (const auto [samples, inputs, outputs, nodes] :
       {std::array{1, 1, 1, 1}, {7, 3, 2, 5}, {129, 6, 3, 65}, {1000, 12, 6, 68}}) {
    const MatrixX x = uniform(samples, inputs, 1, 1), t = uniform(samples, outputs, 1, 2);
    for (const Activation activation : {Activation::sigmoid, Activation::tanh}) {
      const HiddenLayer layer{.nodes = nodes, .activation = activation};
      for (const double limit : {1.0, 1e-4, 300.0}) {
        const VectorX theta = uniform(layer.dimension(inputs), 1, limit, 3);
        MatrixX h;
        layer.outputs(x, theta, h);
        const MatrixX gram = h.transpose() * h, right = t.transpose() * h;
        for (const InstructionSet set : vernier_test::instruction_sets()) {
          detail::LayerEquations equations(layer, x, t, set);
          equations.form(theta);
          equations.form(theta);  // nothing is left over from before
          const MatrixX difference = MatrixX(equations.gram()) - gram;
          EXPECT_LT(MatrixX(difference.triangularView<Eigen::Lower>()).norm(), 1e-12 * gram.norm() + 1e-14);
          EXPECT_LT((equations.right() - right).norm(), 1e-12 * h.norm() * t.norm() + 1e-15 * t.norm());
          EXPECT_NEAR(equations.target_square(), t.squaredNorm(), 1e-13 * t.squaredNorm());
        }
      }
    }
  }
}

/// The objective to 1e-6 against an SVD of the stacked system, at the bounds, with tiny weights and with equal nodes.
TEST(ElmFitness, HoldsSixDigitsWhereverTheWeightsLie) {
  const Index samples = 400, inputs = 6, outputs = 3;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> x = uniform(samples, inputs, 1, 4);
  Eigen::Matrix<double, Eigen::Dynamic, 3> y(samples, outputs);
  for (Index i = 0; i < samples; ++i)
    y.row(i) << std::sin(x(i, 0) + x(i, 1)), x(i, 2) * x(i, 3), std::cos(2 * x(i, 4)) * x(i, 5);
  const Elm elm{.hidden_nodes = 30, .target_scaling = Scaling::none};
  const auto objective = elm.objective(x, y);
  MatrixX population(elm.dimension(6), 6);
  population.col(0) = uniform(population.rows(), 1, 1, 5);
  population.col(1) = population.col(0).array().sign().matrix();  // at the bounds
  population.col(2) = 1e-3 * population.col(0);
  population.col(3) = 1e-7 * population.col(0);
  population.col(4) = population.col(0).head(7).replicate(30, 1);  // equal nodes
  population.col(5) = 1e3 * population.col(0);                     // saturated
  VectorX fitness(6);
  objective(population, fitness);
  for (Index k = 0; k < 6; ++k) {
    MatrixX h;
    const HiddenLayer layer = elm.layer();
    layer.outputs(layer.scaling(x).apply(x), population.col(k), h);
    const double lambda = 1e-10 * h.squaredNorm() / 30;
    MatrixX stacked(samples + 30, 30), right = MatrixX::Zero(samples + 30, 3);
    stacked << h, std::sqrt(lambda) * MatrixX::Identity(30, 30);
    right.topRows(samples) = y;
    const Eigen::JacobiSVD<MatrixX> svd(stacked, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const double expected = (stacked * svd.solve(right) - right).squaredNorm() / static_cast<double>(samples);
    EXPECT_NEAR(fitness(k), expected, 1e-6 * expected) << k;
  }
}

TEST(ElmFitness, ANearlyPerfectFitKeepsItsDigits) {
  // targets that the layer can represent: the products alone would lose everything
  const Eigen::Matrix<double, Eigen::Dynamic, 2> x = uniform(300, 2, 1, 6);
  const Elm elm{
      .hidden_nodes = 10, .input_scaling = Scaling::none, .target_scaling = Scaling::none, .fitness_lambda = 1e-14};
  const VectorX theta = uniform(elm.dimension(2), 1, 1, 7);
  MatrixX h;
  elm.layer().outputs(x, theta, h);
  const Eigen::Matrix<double, Eigen::Dynamic, 1> y = h * uniform(10, 1, 1, 8);
  VectorX fitness(1);
  elm.objective(x, y)(theta, fitness);
  EXPECT_GE(fitness(0), 0);
  EXPECT_LT(fitness(0), 1e-13 * y.squaredNorm());
}

}  // namespace
}  // namespace vernier::normal_equations_test
