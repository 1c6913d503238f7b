// The fitness of one particle against singular values: agreement to 1e-6 where hidden layers are at their worst.

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::relative_ridge_test {
namespace {

constexpr double relative_lambda = 1e-10;

/// `min |H beta - T|^2 + lambda |beta|^2` from the singular values: what the projection misses, and of each direction
/// the share lambda / (s^2 + lambda).
double objective_by_svd(const MatrixX& h, const MatrixX& t) {
  const double lambda = relative_lambda * h.squaredNorm() / static_cast<double>(h.cols());
  const Eigen::JacobiSVD<MatrixX> svd(h, Eigen::ComputeThinU);
  const MatrixX coordinates = svd.matrixU().transpose() * t;
  double sum = (t - svd.matrixU() * coordinates).squaredNorm();
  for (Index j = 0; j < coordinates.rows(); ++j) {
    const double s2 = svd.singularValues()(j) * svd.singularValues()(j);
    sum += lambda / (s2 + lambda) * coordinates.row(j).squaredNorm();
  }
  return sum;
}

struct Problem {
  MatrixX x{250, 3}, t{250, 2};
  Problem() {
    Rng rng(1);
    for (auto& value : x.reshaped()) value = rng.uniform(-1, 1);
    t.col(0) = (2 * x.col(0)).array().sin() * x.col(1).array();
    t.col(1) = (x.col(2) - x.col(0)).array().cos();
  }
};

MatrixX layer(const Problem& problem, const VectorX& theta, int nodes, Activation activation = Activation::sigmoid) {
  MatrixX h;
  HiddenLayer{.nodes = nodes, .activation = activation}.outputs(problem.x, theta, h);
  return h;
}

VectorX random_theta(int nodes, double limit, std::uint64_t seed, bool at_the_bounds = false) {
  Rng rng(seed);
  VectorX theta(4 * nodes);
  for (auto& value : theta) value = at_the_bounds ? limit * rng.sign() : rng.uniform(-limit, limit);
  return theta;
}

void expect_agreement(const MatrixX& h, const MatrixX& t, const char* what) {
  const RidgeSolution solution = relative_ridge(h, t, relative_lambda);
  const double expected = objective_by_svd(h, t);
  EXPECT_NEAR(solution.objective, expected, 1e-6 * expected) << what;
  const double lambda = relative_lambda * h.squaredNorm() / static_cast<double>(h.cols());
  const double of_beta = (h * solution.beta - t).squaredNorm() + lambda * solution.beta.squaredNorm();
  EXPECT_NEAR(of_beta, expected, 1e-6 * expected) << what << ": the weights belong to another objective";
}

TEST(RelativeRidge, RandomWeights) {
  const Problem p;
  for (const Activation activation :
       {Activation::sigmoid, Activation::tanh, Activation::sine, Activation::radial_basis})
    for (const int nodes : {1, 20, 65})
      expect_agreement(layer(p, random_theta(nodes, 1, 2), nodes, activation), p.t, "random");
}

// Signs alone: of 65 nodes on 3 inputs many are equal or opposite.
TEST(RelativeRidge, WeightsAtTheBoundsOfTheBox) {
  const Problem p;
  expect_agreement(layer(p, random_theta(65, 1, 3, true), 65), p.t, "at the bounds");
  expect_agreement(layer(p, VectorX::Constant(4 * 65, -1), 65), p.t, "all at one bound");
}

TEST(RelativeRidge, TinyWeights) {
  const Problem p;
  for (const double limit : {1e-2, 1e-4, 1e-6, 1e-9}) {
    expect_agreement(layer(p, random_theta(30, limit, 4), 30), p.t, "tiny, sigmoid");
    expect_agreement(layer(p, random_theta(30, limit, 4), 30, Activation::tanh), p.t, "tiny, tanh");
  }
}

TEST(RelativeRidge, EqualNodes) {
  const Problem p;
  VectorX theta = random_theta(30, 1, 5);
  for (int k = 1; k < 30; ++k) theta.segment(4 * k, 4) = theta.head(4);
  expect_agreement(layer(p, theta, 30), p.t, "all equal");
  theta = random_theta(30, 1, 5);
  theta.tail(60) = theta.head(60);
  expect_agreement(layer(p, theta, 30), p.t, "in pairs");
}

TEST(RelativeRidge, SaturatedWeights) {
  const Problem p;
  expect_agreement(layer(p, random_theta(30, 1e3, 6), 30), p.t, "saturated, sigmoid");
  expect_agreement(layer(p, random_theta(30, 1e3, 6), 30, Activation::tanh), p.t, "saturated, tanh");
}

// Targets the nodes can meet exactly: all that is left is the ridge itself, eleven decades below the targets.
TEST(RelativeRidge, NearlyPerfectFit) {
  const Problem p;
  const MatrixX h = layer(p, random_theta(8, 1, 7), 8);
  expect_agreement(h, h * MatrixX::Ones(8, 2), "perfect");
}

TEST(RelativeRidge, FewerSamplesThanNodes) {
  const Problem p;
  const MatrixX h = layer(p, random_theta(40, 1, 8), 40);
  expect_agreement(h.topRows(10), p.t.topRows(10), "10 samples, 40 nodes");
}

TEST(RelativeRidge, ZeroLayerLeavesTheTargets) {
  const Problem p;
  const RidgeSolution solution = relative_ridge(MatrixX::Zero(250, 5), p.t, relative_lambda);
  EXPECT_EQ(solution.beta, MatrixX::Zero(5, 2));
  EXPECT_DOUBLE_EQ(solution.objective, p.t.squaredNorm());
}

TEST(RelativeRidge, LayerThatIsNotFiniteIsTheWorst) {
  const Problem p;
  MatrixX h = layer(p, random_theta(5, 1, 9), 5);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    h(3, 2) = value;
    EXPECT_EQ(relative_ridge(h, p.t, relative_lambda).objective, std::numeric_limits<double>::infinity());
  }
}

// The fitness a search sees, whichever way it is computed, at the weights of the tests above.
TEST(ElmObjective, AgreesAtItsWorst) {
  const Problem p;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> x = p.x;
  Eigen::Matrix<double, Eigen::Dynamic, 2> t = p.t;
  for (const Activation activation :
       {Activation::sigmoid, Activation::tanh, Activation::sine, Activation::radial_basis}) {
    const Elm elm{
        .hidden_nodes = 30, .activation = activation, .input_scaling = Scaling::none, .target_scaling = Scaling::none};
    MatrixX population(120, 9);
    population << random_theta(30, 1, 2), random_theta(30, 1, 3, true), VectorX::Constant(120, -1),
        random_theta(30, 1e-2, 4), random_theta(30, 1e-6, 5), random_theta(30, 1e3, 6),
        random_theta(30, 1, 7).head(4).replicate(30, 1), random_theta(30, 3, 8), VectorX::Zero(120);
    for (const bool nearly_perfect : {false, true}) {
      if (nearly_perfect) t = layer(p, population.col(0), 30, activation).leftCols(2);
      VectorX fitness(9);
      elm.objective(x, t)(population, fitness);
      for (Index k = 0; k < 9; ++k) {
        const MatrixX h = layer(p, population.col(k), 30, activation);
        const double expected = h.isZero(0) ? t.squaredNorm() : objective_by_svd(h, t);
        EXPECT_NEAR(250 * fitness(k), expected, 1e-6 * expected)
            << "activation " << static_cast<int>(activation) << ", column " << k << ", perfect " << nearly_perfect;
      }
    }
  }
}

// What a search sees: the objective per sample, of scaled inputs and targets.
TEST(ElmObjective, IsTheRidgeObjectivePerSampleInScaledUnits) {
  const Problem p;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> x = 4 * p.x.array() + 7;
  const Eigen::Matrix<double, Eigen::Dynamic, 2> t = 1e-3 * p.t;
  const Elm elm{.hidden_nodes = 12};
  MatrixX population(elm.dimension(3), 3), scaled_x(250, 3), scaled_t(250, 2);
  for (Index k = 0; k < 3; ++k) population.col(k) = random_theta(12, 1, 20 + static_cast<std::uint64_t>(k));
  for (Index j = 0; j < 3; ++j) {
    const double low = x.col(j).minCoeff(), high = x.col(j).maxCoeff();
    scaled_x.col(j) = (2 * (x.col(j).array() - low) / (high - low) - 1).matrix();
  }
  for (Index j = 0; j < 2; ++j) {
    const double low = t.col(j).minCoeff(), high = t.col(j).maxCoeff();
    scaled_t.col(j) = (2 * (t.col(j).array() - low) / (high - low) - 1).matrix();
  }
  VectorX fitness(3);
  elm.objective(x, t)(population, fitness);
  for (Index k = 0; k < 3; ++k) {
    MatrixX h;
    HiddenLayer{.nodes = 12}.outputs(scaled_x, population.col(k), h);
    EXPECT_NEAR(fitness(k), objective_by_svd(h, scaled_t) / 250, 1e-6 * fitness(k));
  }
}

}  // namespace
}  // namespace vernier::relative_ridge_test
