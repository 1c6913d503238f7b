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

using vernier_test::above;
using vernier_test::complaint;
using vernier_test::difference;
using vernier_test::elements;
using vernier_test::hidden_outputs;
using vernier_test::Inputs;
using vernier_test::RealMatrix;
using vernier_test::samples_of;
using vernier_test::scaled_rows;
using vernier_test::Targets;
using vernier_test::zeros;

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

/// The ridge problem as a stacked system.
double training_error(const Elm& elm, const Inputs& x, const Targets& y, const VectorX& theta) {
  const MatrixX mapped = elm.layer().map(x);
  const RealMatrix h = hidden_outputs(elm.layer(), elm.layer().scaling(mapped).apply(mapped), theta);
  const RealMatrix t = ColumnScaling::fit(y, elm.target_scaling).apply(y);
  const double lambda = elm.fitness_lambda * h.squared_norm() / elm.hidden_nodes;
  const RealMatrix stacked = above(h, std::sqrt(lambda) * RealMatrix::identity(elm.hidden_nodes)),
                   right = above(t, zeros(elm.hidden_nodes, 2));
  return (stacked * stacked.solve(right) - right).squared_norm() / static_cast<double>(h.rows());
}

TEST(ElmFitness, IsTheTrainingError) {
  const Inputs x = vernier_test::inputs(403, 2);
  const Targets y = vernier_test::targets(x, 3e-5);
  for (const Activation activation : vernier_test::activations)
    for (const double size : {1e-3, 0.3, 1.0, 4.0}) {
      const Elm elm{.hidden_nodes = 15, .activation = activation, .weight_limit = size};
      const VectorX theta = elm.layer().draw(3, 3);
      EXPECT_NEAR(fitness_of(elm, x, y, theta) / training_error(elm, x, y, theta), 1, 1e-6)
          << static_cast<int>(activation) << ' ' << size;
    }
}

TEST(ElmFitness, ParticlesAreIndependent) {
  const Inputs x = vernier_test::inputs(50, 2);
  const Targets y = vernier_test::targets(x);
  const Elm elm{.hidden_nodes = 7};
  std::vector<VectorX> population;
  for (std::uint64_t k = 0; k < 3; ++k) population.push_back(elm.layer().draw(3, k));
  VectorX fitness(3);
  elm.objective(x, y)(vernier_test::beside(population), fitness);
  for (Index k = 0; k < 3; ++k) EXPECT_EQ(fitness(k), fitness_of(elm, x, y, population[static_cast<std::size_t>(k)]));
}

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

TEST(ElmFitness, OnlyRatiosOfWeightsMatter) {
  const Inputs x = vernier_test::inputs(60, 1);
  const Targets y = vernier_test::targets(x);
  const Elm elm{.hidden_nodes = 9};
  const VectorX theta = elm.layer().draw(3, 4);
  VectorX weights = VectorX::Ones(60);
  EXPECT_NEAR(fitness_of(elm, x, y, theta, &weights) / fitness_of(elm, x, y, theta), 1, 1e-12);
  weights *= 7;
  EXPECT_NEAR(fitness_of(elm, x, y, theta, &weights) / fitness_of(elm, x, y, theta), 1, 1e-9);
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

TEST(ElmFitness, RefusesMisuse) {
  const Inputs x = vernier_test::inputs(20, 1);
  const Targets y = vernier_test::targets(x);
  const VectorX theta = VectorX::Ones(8);
  const VectorX few = VectorX::Ones(19), negative = -VectorX::Ones(20);
  const Elm elm{.hidden_nodes = 2};
  EXPECT_NE(complaint([&] { fitness_of(elm, x, y, theta, &few); }).find("19 weights for 20 samples"),
            std::string::npos);
  EXPECT_NE(complaint([&] { static_cast<void>(elm.fit(x, y, {.weights = &negative})); }).find("go down to -1"),
            std::string::npos);
  EXPECT_NE(complaint([&] { static_cast<void>(RidgeElm{}.fit(x, y, {.weights = &few})); }).find("19 weights"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::elm_fitness_test
