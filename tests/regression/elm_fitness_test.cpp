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

using vernier_test::complaint;
using vernier_test::Inputs;
using vernier_test::Targets;

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
    all_x = x(rows, Eigen::all);
    all_y = y(rows, Eigen::all);
  }
};

/// The ridge problem by singular values of the stacked system.
double training_error(const Elm& elm, const Inputs& x, const Targets& y, const VectorX& theta) {
  const MatrixX mapped = elm.layer().map(x);
  MatrixX h;
  elm.layer().outputs(elm.layer().scaling(mapped).apply(mapped), theta, h);
  const MatrixX t = ColumnScaling::fit(y, elm.target_scaling).apply(y);
  const double lambda = elm.fitness_lambda * h.squaredNorm() / elm.hidden_nodes;
  MatrixX stacked(h.rows() + elm.hidden_nodes, elm.hidden_nodes), right = MatrixX::Zero(stacked.rows(), 2);
  stacked << h, std::sqrt(lambda) * MatrixX::Identity(elm.hidden_nodes, elm.hidden_nodes);
  right.topRows(h.rows()) = t;
  const MatrixX beta = Eigen::JacobiSVD<MatrixX>(stacked, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(right);
  return (stacked * beta - right).squaredNorm() / static_cast<double>(h.rows());
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
  MatrixX population(elm.dimension(3), 3);
  for (Index k = 0; k < 3; ++k) population.col(k) = elm.layer().draw(3, static_cast<std::uint64_t>(k));
  VectorX fitness(3);
  elm.objective(x, y)(population, fitness);
  for (Index k = 0; k < 3; ++k) EXPECT_EQ(fitness(k), fitness_of(elm, x, y, population.col(k)));
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
    EXPECT_LT((weighted.predict(at.x) - elm.fit_at(at.all_x, at.all_y, theta).predict(at.x)).cwiseAbs().maxCoeff(),
              1e-11);
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
MatrixX refits(const MatrixX& h, const MatrixX& t, const VectorX& weights, double lambda) {
  const Index n = h.rows(), nodes = h.cols();
  const VectorX roots = (weights / weights.mean()).cwiseSqrt();
  MatrixX out(n, t.cols());
  for (Index left = 0; left < n; ++left) {
    MatrixX a = MatrixX::Zero(n + nodes, nodes + 1), b = MatrixX::Zero(n + nodes, t.cols());
    a.topLeftCorner(n, 1) = roots;
    a.topRightCorner(n, nodes) = roots.asDiagonal() * h;
    a.bottomRightCorner(nodes, nodes).diagonal().setConstant(std::sqrt(lambda));
    b.topRows(n) = roots.asDiagonal() * t;
    a.row(left).setZero();
    b.row(left).setZero();
    const MatrixX found = a.householderQr().solve(b);
    out.row(left) = roots(left) * (t.row(left) - found.row(0) - h.row(left) * found.bottomRows(nodes));
  }
  return out;
}

TEST(RidgePath, WeightedLeaveOneOutEqualsRefits) {
  const auto random = [](Index rows, Index columns, std::uint64_t seed) {
    Rng rng(seed);
    MatrixX out(rows, columns);
    for (auto& value : out.reshaped()) value = rng.normal();
    return out;
  };
  for (const auto& [n, nodes] : {std::tuple<Index, Index>{30, 5}, {12, 11}, {10, 20}}) {
    const MatrixX h = random(n, nodes, 1).array() + 2, t = random(n, 2, 2).array() + 5;
    const VectorX weights = random(n, 1, 3).array().abs() + 0.1;
    const RidgePath path(h, t, &weights);
    for (const double lambda : {1e-2, 1.0, 100.0})
      EXPECT_LT((path.leave_one_out_residuals(lambda) - refits(h, t, weights, lambda)).cwiseAbs().maxCoeff(), 1e-9)
          << n << ' ' << nodes << ' ' << lambda;
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_LT((path.leave_one_out_residuals(infinity) - refits(h, t, weights, 1e12)).cwiseAbs().maxCoeff(), 1e-6);
    // as many weights of one as samples: the path without weights
    const VectorX ones = VectorX::Constant(n, 3);
    EXPECT_LT((RidgePath(h, t, &ones).beta(0.5) - RidgePath(h, t).beta(0.5)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(RidgeElm, WeightsReachFitnessAndFit) {
  const Repeated at;
  const RidgeElm ridge{.hidden_nodes = 25};
  const VectorX theta = ridge.layer().draw(3, 4);
  MatrixX h;
  ridge.layer().outputs(ridge.layer().map(at.x), theta, h);
  const RidgePath path(h, at.y, &at.weights);
  const auto choice = choose_lambda(path, 60);
  ASSERT_TRUE(std::isfinite(choice.lambda)) << "the mean alone would prove nothing";
  EXPECT_NEAR(fitness_of(ridge, at.x, at.y, theta, &at.weights) / choice.mean_squared_error, 1, 1e-12);
  const auto fitted = ridge.fit_at(at.x, at.y, theta, {.weights = &at.weights});
  EXPECT_LT((fitted.beta() - path.beta(choice.lambda)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT((fitted.beta() - ridge.fit_at(at.x, at.y, theta).beta()).cwiseAbs().maxCoeff(), 1e-9);
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
