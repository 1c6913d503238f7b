// SPDX-License-Identifier: BSD-3-Clause
// The objective of a search and sample weights, against problems written out.

#include "vernier/regression/detail/elm_fitness.hpp"

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "complaint.hpp"
#include "regression_samples.hpp"
#include "vernier/regression/elm.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/ridge_elm.hpp"

namespace vernier::elm_fitness_test {
namespace {

using namespace vernier_test;

template <class R>
double fitness_of(const R& recipe, const Inputs& x, const Targets& y, const VectorX& theta,
                  const VectorX* weights = nullptr) {
  VectorX fitness(1);
  recipe.objective(x, y, weights)(theta, fitness);
  return fitness(0);
}

/// Samples of which some appear more than once, and the same with integer weights instead.
struct Repeated {
  Inputs x = vernier_test::inputs(60, 1), all_x;
  Targets y = vernier_test::targets(x), all_y;
  VectorX weights = VectorX::Ones(60);
  Repeated() {
    std::vector<Index> rows;
    for (Index i = 0; i < 60; ++i) {
      weights(i) = 1 + static_cast<double>(i % 3);
      for (Index k = 0; k <= i % 3; ++k) rows.push_back(i);
    }
    all_x = samples_of(x, rows);
    all_y = samples_of(y, rows);
  }
};

// A sample of weight 2 counts as two: in the fitness, whichever path it takes, and in the fit.
TEST(ElmFitness, WeightsAreRepetitions) {
  const Repeated at;
  for (const Activation activation : vernier_test::activations) {
    const Elm elm{.hidden_nodes = 9, .activation = activation};
    const VectorX theta = elm.layer().draw(3, 4);
    const double repeated = fitness_of(elm, at.all_x, at.all_y, theta);
    EXPECT_NEAR(fitness_of(elm, at.x, at.y, theta, &at.weights) / repeated, 1, 1e-7);
    EXPECT_GT(std::abs(fitness_of(elm, at.x, at.y, theta) / repeated - 1), 1e-3) << "the weights must matter";
    const auto weighted = elm.fit_at(at.x, at.y, theta, {.weights = &at.weights});
    const auto of_all = elm.fit_at(at.all_x, at.all_y, theta);
    EXPECT_LT(difference(weighted.predict(at.x), of_all.predict(at.x)), 1e-11);
  }
}

/// Leave-one-out with weights by refits: the ridge with a free mean, in weights whose mean is 1.
RealMatrix refits(const RealMatrix& h, const RealMatrix& t, const RealMatrix& weights, double lambda) {
  const Index n = h.rows(), nodes = h.cols();
  const RealMatrix roots = (weights / weights.mean()).sqrt();
  const RealMatrix a = above(beside(roots, scaled_rows(roots, h)),
                             beside(zeros(nodes, 1), std::sqrt(lambda) * RealMatrix::identity(nodes)));
  const RealMatrix b = above(scaled_rows(roots, t), zeros(nodes, t.cols()));
  RealMatrix out(n, t.cols());
  for (Index left = 0; left < n; ++left) {
    RealMatrix others = a, targets = b;
    others.set_block(left, 0, zeros(1, nodes + 1));
    targets.set_block(left, 0, zeros(1, t.cols()));
    const RealMatrix found = others.solve(targets);
    out.set_block(left, 0, roots(left) * (t.row(left) - found.row(0) - h.row(left) * bottom(found, nodes)));
  }
  return out;
}

TEST(RidgePath, WeightedLeaveOneOutEqualsRefits) {
  const auto random = [](Index rows, Index columns, std::uint64_t seed, double mean = 0) {
    Rng rng(seed);
    MatrixX out(rows, columns);
    for (double& value : elements(out)) value = rng.normal() + mean;
    return out;
  };
  for (const auto& [n, nodes] : {std::tuple<Index, Index>{30, 5}, {12, 11}, {10, 20}}) {
    const MatrixX h = random(n, nodes, 1, 2), t = random(n, 2, 2, 5);
    VectorX weights = RealMatrix(random(n, 1, 3));
    for (double& weight : weights) weight = std::abs(weight) + 0.1;
    const RidgePath path(h, t, &weights);
    for (const double lambda : {1e-2, 1.0, 100.0})
      EXPECT_LT(difference(path.leave_one_out_residuals(lambda), refits(h, t, weights, lambda)), 1e-9)
          << n << ' ' << nodes << ' ' << lambda;
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_LT(difference(path.leave_one_out_residuals(infinity), refits(h, t, weights, 1e12)), 1e-6);
    // as many weights of one as samples: the path without weights
    const VectorX ones = VectorX::Constant(n, 3);
    EXPECT_LT(difference(RidgePath(h, t, &ones).beta(0.5), RidgePath(h, t).beta(0.5)), 1e-12);
  }
}

TEST(RidgeElm, WeightsReachFitnessAndFit) {
  const Repeated at;
  const RidgeElm ridge{.hidden_nodes = 25};
  const VectorX theta = ridge.layer().draw(3, 4);
  const RidgePath path(hidden_outputs(ridge.layer(), ridge.layer().map(at.x), theta), at.y, &at.weights);
  const auto choice = choose_lambda(path, 60);
  ASSERT_TRUE(std::isfinite(choice.lambda)) << "the mean alone would prove nothing";
  EXPECT_NEAR(fitness_of(ridge, at.x, at.y, theta, &at.weights) / choice.mean_squared_error, 1, 1e-12);
  const auto fitted = ridge.fit_at(at.x, at.y, theta, {.weights = &at.weights});
  EXPECT_LT(difference(fitted.beta(), path.beta(choice.lambda)), 1e-12);
  EXPECT_GT(difference(fitted.beta(), ridge.fit_at(at.x, at.y, theta).beta()), 1e-9);
}

TEST(ElmFitness, RefusesAnotherNumberOfWeights) {
  const Inputs x = vernier_test::inputs(20, 1);
  const VectorX few = VectorX::Ones(19);
  EXPECT_NE(complaint([&] { (void)Elm{}.objective(x, vernier_test::targets(x), &few); }).find("19 weights for 20"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::elm_fitness_test
