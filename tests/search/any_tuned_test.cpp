// SPDX-License-Identifier: BSD-3-Clause
// Fits to samples of sizes known at run time have the bits of those known at compile time.
#include "vernier/search/any_tuned.hpp"

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"

namespace vernier::any_tuned_test {
namespace {

using Inputs = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Targets = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Smooth functions with noise.
struct Samples {
  Inputs x = Inputs(60, 3);
  Targets y = Targets(60, 2);
  VectorX weights = VectorX(60);

  Samples() {
    Rng rng(5);
    for (Index i = 0; i < x.rows(); ++i) {
      for (Index k = 0; k < 3; ++k) x(i, k) = rng.uniform(-2, 2);
      y(i, 0) = std::sin(x(i, 0)) * x(i, 1) + 0.01 * rng.uniform(-1, 1);
      y(i, 1) = std::cos(x(i, 2)) + 0.01 * rng.uniform(-1, 1);
      weights(i) = rng.uniform(0.5, 2);
    }
  }
};

template <class Recipe>
void expect_same_bits(const Recipe& recipe, bool weighted) {
  const Samples samples;
  FitOptions options{.seed = 3};
  if (weighted) options.weights = &samples.weights;
  const auto fixed = recipe.fit(samples.x, samples.y, options);
  const AnyPredictor any = fit_any(recipe, MatrixX(samples.x), MatrixX(samples.y), options);
  EXPECT_EQ(any.inputs(), 3);
  EXPECT_EQ(any.outputs(), 2);
  EXPECT_EQ(any.predict(samples.x), MatrixX(fixed.predict(samples.x)));
  EXPECT_EQ(any.derivative(samples.x.row(7).transpose()), MatrixX(fixed.derivative(Vector3(samples.x.row(7)))));
  EXPECT_THROW(any.predict(MatrixX::Zero(4, 2)), std::invalid_argument);
  PredictorParts parts = any.parts();
  const AnyPredictor again(parts);
  EXPECT_EQ(again.predict(samples.x), any.predict(samples.x));
  EXPECT_EQ(again.nodes(), any.nodes());
  if constexpr (requires { fixed.standard_deviation(Vector3()); }) {
    ASSERT_TRUE(any.uncertain());
    const MatrixX deviations = any.standard_deviations(samples.x);
    for (Index i = 0; i < samples.x.rows(); ++i)
      EXPECT_EQ(VectorX(deviations.row(i)), VectorX(fixed.standard_deviation(Vector3(samples.x.row(i)))));
    EXPECT_EQ(again.standard_deviations(samples.x), deviations);
    parts.spread->inverse.pop_back();
    EXPECT_THROW(AnyPredictor{parts}, std::invalid_argument);
  } else {
    EXPECT_THROW(any.standard_deviations(samples.x), std::invalid_argument);
  }
}

TEST(AnyTuned, RecipesHaveTheBitsOfFixedSizes) {
  expect_same_bits(Elm{.hidden_nodes = 12}, false);
  expect_same_bits(Elm{.hidden_nodes = 12}, true);
  expect_same_bits(RidgeElm{.hidden_nodes = 20}, true);
  expect_same_bits(VarProElm{.hidden_nodes = 5, .iterations = 20}, true);
  expect_same_bits(KernelElm{}, true);
  expect_same_bits(GaussianProcess{.starts = 1}, true);
}

TEST(AnyTuned, HybridsHaveTheBitsOfFixedSizes) {
  expect_same_bits(Tuned{Elm{.hidden_nodes = 8}, Pso{.particles = 6, .iterations = 5}}, true);
  expect_same_bits(Tuned{RidgeElm{.hidden_nodes = 8}, GeneticAlgorithm{.individuals = 6, .generations = 5}}, false);
  expect_same_bits(Tuned{VarProElm{.hidden_nodes = 4, .iterations = 5}, Pso{.particles = 4, .iterations = 2}}, false);
}

TEST(AnyTuned, RefusesUnusableSamples) {
  EXPECT_THROW(fit_any(Elm{}, MatrixX::Zero(3, 2), MatrixX::Zero(4, 1)), std::invalid_argument);
  for (const int nodes : {0, -1}) {
    EXPECT_THROW(fit_any(Elm{.hidden_nodes = nodes}, MatrixX::Zero(3, 2), MatrixX::Zero(3, 1)), std::invalid_argument);
    EXPECT_THROW(fit_any(RidgeElm{.hidden_nodes = nodes}, MatrixX::Zero(3, 2), MatrixX::Zero(3, 1)),
                 std::invalid_argument);
    EXPECT_THROW(fit_any(Tuned{Elm{.hidden_nodes = nodes}, Pso{}}, MatrixX::Zero(3, 2), MatrixX::Zero(3, 1)),
                 std::invalid_argument);
  }
  PredictorParts parts = fit_any(Elm{.hidden_nodes = 4}, MatrixX::Random(9, 2), MatrixX::Random(9, 1)).parts();
  parts.nodes.conservativeResize(parts.nodes.size() - 1);
  EXPECT_THROW(AnyPredictor{parts}, std::invalid_argument);
  parts.node_function = 17;
  EXPECT_THROW(AnyPredictor{parts}, std::invalid_argument);
  const Tuned part{Elm{}, Pso{}, {}, 2};
  EXPECT_THROW(fit_any(part, MatrixX::Zero(3, 2), MatrixX::Zero(3, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::any_tuned_test
