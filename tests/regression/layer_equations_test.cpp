// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/regression/detail/layer_equations.hpp"

#include <gtest/gtest.h>

#include "instruction_sets.hpp"
#include "regression_samples.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::normal_equations_test {
namespace {

using namespace vernier_test;

MatrixX uniform(Index rows, Index columns, double limit, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, columns);
  for (double& x : elements(out)) x = rng.uniform(-limit, limit);
  return out;
}
VectorX uniform(Index size, double limit, std::uint64_t seed) { return RealMatrix(uniform(size, 1, limit, seed)); }

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
        const VectorX theta = uniform(layer.dimension(inputs), limit, 3);
        const RealMatrix h = hidden_outputs(layer, x, theta);
        const RealMatrix gram = h.transpose() * h, right = RealMatrix(t).transpose() * h;
        for (const InstructionSet set : vernier_test::instruction_sets()) {
          detail::LayerEquations equations(layer, x, t, set);
          equations.form(theta);
          equations.form(theta);  // nothing is left over from before
          const RealMatrix found = RealMatrix::of(equations.gram());
          EXPECT_LT(lower_triangle(found - gram).norm(), 1e-12 * gram.norm() + 1e-14);
          EXPECT_LT((RealMatrix::of(equations.right()) - right).norm(), 1e-12 * h.norm() * t.norm() + 1e-15 * t.norm());
          EXPECT_NEAR(equations.target_square(), t.squaredNorm(), 1e-13 * t.squaredNorm());
        }
      }
    }
  }
}

// By the products of the layer's outputs, of which the lower triangle counts; nothing where there is no ridge or the
// products are not positive definite.
TEST(RidgeWeights, SolveTheNormalEquations) {
  const RealMatrix h = uniform(30, 5, 1, 9), t = uniform(30, 2, 1, 10);
  const RealMatrix gram = h.transpose() * h, right = t.transpose() * h;
  const double lambda = 0.3;
  const RealMatrix beta = (gram + lambda * RealMatrix::identity(5)).inverse() * h.transpose() * t;
  EXPECT_LT((ridge_weights(lower_triangle(gram), right, lambda) - beta).norm(), 1e-13);
  const double trace = gram.trace(), square = t.squared_norm(),
               expected = (h * beta - t).squared_norm() + lambda * beta.squared_norm();
  EXPECT_NEAR(objective_from_products(lower_triangle(gram), right, square, beta, lambda, trace), expected, 1e-12);
  EXPECT_NEAR(relative_ridge_objective(lower_triangle(gram), right, square, lambda * 5 / trace), expected, 1e-12);
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_EQ(ridge_weights(gram, right, none).size(), 0);
  EXPECT_EQ(ridge_weights(-gram, right, lambda).size(), 0);
  EXPECT_EQ(objective_from_products(gram, right, square, MatrixX(), lambda, trace), -1);
  // too few digits: a fit that leaves a ten millionth of the targets' square, or weights that are huge
  EXPECT_EQ(objective_from_products(gram, h.transpose().row(0) * h, h.col(0).squared_norm(), vector({1, 0, 0, 0, 0}),
                                    1e-9, trace),
            -1);
  EXPECT_EQ(objective_from_products(gram, right, square, beta, lambda, 1e8 * expected / beta.squared_norm() * 1.01),
            -1);
  EXPECT_GT(objective_from_products(gram, right, square, beta, lambda, 1e8 * expected / beta.squared_norm() * 0.99), 0);
}

// At other weights than the best it is the objective there; below a ten millionth of the targets' square nothing.
TEST(ObjectiveFromProducts, IsTheObjectiveAtAnyWeights) {
  const RealMatrix h = uniform(20, 3, 1, 11), t = uniform(20, 2, 1, 12), beta = uniform(3, 2, 1, 13);
  const RealMatrix gram = h.transpose() * h, right = t.transpose() * h;
  const double expected = (h * beta - t).squared_norm() + 0.3 * beta.squared_norm();
  EXPECT_NEAR(objective_from_products(lower_triangle(gram), right, t.squared_norm(), beta, 0.3, gram.trace()), expected,
              1e-12);
  // one sample that a node of value 1 meets, and one of value r that it does not
  const MatrixX one = MatrixX::Ones(1, 1);
  EXPECT_EQ(objective_from_products(one, one, 1 + 0.9e-7, one, 1e-12, 1), -1);
  EXPECT_NEAR(objective_from_products(one, one, 1 + 1.1e-7, one, 1e-12, 1), 1.1e-7, 1e-11);
}

}  // namespace
}  // namespace vernier::normal_equations_test
