// SPDX-License-Identifier: BSD-3-Clause
// The fitness of one particle against a QR decomposition: agreement to 1e-6 where hidden layers are at their worst.

#include <gtest/gtest.h>

#include "regression_samples.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"

namespace vernier::relative_ridge_test {
namespace {

using namespace vernier_test;

constexpr double relative_lambda = 1e-10;

/// `min |H beta - T|^2 + lambda |beta|^2`, by a QR decomposition of H with sqrt(lambda) I below it.
double objective_by_qr(const RealMatrix& h, const RealMatrix& t) {
  const Index n = h.rows(), p = h.cols();
  const double lambda = relative_lambda * h.squared_norm() / static_cast<double>(p);
  RealMatrix rows(n + p, p), targets(n + p, t.cols());
  rows.set_block(0, 0, h);
  rows.set_block(n, 0, std::sqrt(lambda) * RealMatrix::identity(p));
  targets.set_block(0, 0, t);
  return (rows * rows.solve(targets) - targets).squared_norm();
}

struct Problem {
  PointRows x{250, 3};
  RealMatrix t{250, 2};
  Problem() {
    Rng rng(1);
    for (double& value : elements(x)) value = rng.uniform(-1, 1);
    for (Index i = 0; i < 250; ++i) {
      t(i, 0) = std::sin(2 * x(i, 0)) * x(i, 1);
      t(i, 1) = std::cos(x(i, 2) - x(i, 0));
    }
  }
};

RealMatrix layer(const Problem& problem, const VectorX& theta, int nodes, Activation activation = Activation::sigmoid) {
  return hidden_outputs({.nodes = nodes, .activation = activation}, problem.x, theta);
}

VectorX random_theta(int nodes, double limit, std::uint64_t seed, bool at_the_bounds = false) {
  Rng rng(seed);
  VectorX theta(4 * nodes);
  for (double& value : elements(theta)) value = at_the_bounds ? limit * rng.sign() : rng.uniform(-limit, limit);
  return theta;
}

void expect_agreement(const RealMatrix& h, const RealMatrix& t, const char* what) {
  const RidgeSolution solution = relative_ridge(h, t, relative_lambda);
  const RealMatrix beta = solution.beta;
  const double expected = objective_by_qr(h, t);
  EXPECT_NEAR(solution.objective, expected, 1e-6 * expected) << what;
  const double lambda = relative_lambda * h.squared_norm() / static_cast<double>(h.cols());
  const double of_beta = (h * beta - t).squared_norm() + lambda * beta.squared_norm();
  EXPECT_NEAR(of_beta, expected, 1e-6 * expected) << what << ": the weights belong to another objective";
}

TEST(RelativeRidge, HoldsSixDigits) {
  const Problem p;
  for (const Activation activation : activations)
    for (const int nodes : {1, 20, 65})
      expect_agreement(layer(p, random_theta(nodes, 1, 2), nodes, activation), p.t, "random");
  // signs alone: of 65 nodes on 3 inputs many are equal or opposite
  expect_agreement(layer(p, random_theta(65, 1, 3, true), 65), p.t, "at the bounds");
  expect_agreement(layer(p, VectorX::Constant(4 * 65, -1), 65), p.t, "all at one bound");
  for (const Activation activation : {Activation::sigmoid, Activation::tanh}) {
    for (const double limit : {1e-2, 1e-4, 1e-6, 1e-9})
      expect_agreement(layer(p, random_theta(30, limit, 4), 30, activation), p.t, "tiny");
    expect_agreement(layer(p, random_theta(30, 1e3, 6), 30, activation), p.t, "saturated");
  }
  for (const Index apart : {4, 60}) {
    VectorX theta = random_theta(30, 1, 5);
    for (Index i = apart; i < 120; ++i) theta(i) = theta(i - apart);
    expect_agreement(layer(p, theta, 30), p.t, apart == 4 ? "all equal" : "in pairs");
  }
  // targets the nodes can meet exactly: all that is left is the ridge itself, eleven decades below the targets
  const RealMatrix few = layer(p, random_theta(8, 1, 7), 8), many = layer(p, random_theta(40, 1, 8), 40);
  expect_agreement(few, few * filled(8, 2, 1), "perfect");
  expect_agreement(top(many, 10), top(p.t, 10), "10 samples, 40 nodes");
}

TEST(RelativeRidge, ZeroLayerLeavesTheTargets) {
  const Problem p;
  const RidgeSolution solution = relative_ridge(zeros(250, 5), p.t, relative_lambda);
  EXPECT_EQ(RealMatrix(solution.beta), zeros(5, 2));
  EXPECT_DOUBLE_EQ(solution.objective, p.t.squared_norm());
}

TEST(RelativeRidge, LayerThatIsNotFiniteIsTheWorst) {
  const Problem p;
  RealMatrix h = layer(p, random_theta(5, 1, 9), 5);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    h(3, 2) = value;
    EXPECT_EQ(relative_ridge(h, p.t, relative_lambda).objective, std::numeric_limits<double>::infinity());
  }
}

// The fitness a search sees, whichever way it is computed, at the weights of the tests above.
TEST(ElmObjective, AgreesAtItsWorst) {
  const Problem p;
  for (const Activation activation :
       {Activation::sigmoid, Activation::tanh, Activation::sine, Activation::radial_basis}) {
    const Elm elm{
        .hidden_nodes = 30, .activation = activation, .input_scaling = Scaling::none, .target_scaling = Scaling::none};
    VectorX equal_nodes = random_theta(30, 1, 7);
    for (Index i = 4; i < 120; ++i) equal_nodes(i) = equal_nodes(i - 4);
    const std::vector<VectorX> population{random_theta(30, 1, 2),
                                          random_theta(30, 1, 3, true),
                                          VectorX::Constant(120, -1),
                                          random_theta(30, 1e-2, 4),
                                          random_theta(30, 1e-6, 5),
                                          random_theta(30, 1e3, 6),
                                          equal_nodes,
                                          random_theta(30, 3, 8),
                                          VectorX::Zero(120)};
    for (const bool nearly_perfect : {false, true}) {
      const RealMatrix t = nearly_perfect ? layer(p, population[0], 30, activation).block(0, 0, 250, 2) : p.t;
      VectorX fitness(9);
      elm.objective(p.x, as_targets(t))(beside(population), fitness);
      for (Index k = 0; k < 9; ++k) {
        const RealMatrix h = layer(p, population[static_cast<std::size_t>(k)], 30, activation);
        const double expected = h.largest() == 0 ? t.squared_norm() : objective_by_qr(h, t);
        EXPECT_NEAR(250 * fitness(k), expected, 1e-6 * expected)
            << "activation " << static_cast<int>(activation) << ", column " << k << ", perfect " << nearly_perfect;
      }
    }
  }
}

// What a search sees: the objective per sample, of scaled inputs and targets.
TEST(ElmObjective, IsTheRidgeObjectivePerSampleInScaledUnits) {
  const Problem p;
  PointRows x = p.x;
  for (double& value : elements(x)) value = 4 * value + 7;
  const RealMatrix t = 1e-3 * p.t;
  const Elm elm{.hidden_nodes = 12};
  const std::vector<VectorX> population{random_theta(12, 1, 20), random_theta(12, 1, 21), random_theta(12, 1, 22)};
  VectorX fitness(3);
  elm.objective(x, as_targets(t))(beside(population), fitness);
  const RealMatrix scaled_x = vernier_test::scaled_to_range_of(x, x), scaled_t = scaled_to_range_of(t, t);
  for (Index k = 0; k < 3; ++k) {
    const RealMatrix h = hidden_outputs({.nodes = 12}, scaled_x, population[static_cast<std::size_t>(k)]);
    EXPECT_NEAR(fitness(k), objective_by_qr(h, scaled_t) / 250, 1e-6 * fitness(k));
  }
}

}  // namespace
}  // namespace vernier::relative_ridge_test
