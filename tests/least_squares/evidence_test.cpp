// SPDX-License-Identifier: BSD-3-Clause
// Evidence against the density of a Gaussian, written out; sizes of priors against where its slope vanishes.

#include "vernier/least_squares/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "local_states.hpp"
#include "random_blocks.hpp"

namespace vernier::evidence_test {
namespace {

using vernier_test::LocalStates;
using vernier_test::RealMatrix;
using vernier_test::vector;

/// log density of the residuals at the prior means, over all variances of the noise; up to a constant: Student's
/// distribution of 30 degrees of freedom in n dimensions.
double marginal(const LocalStates& problem, const VectorX& precisions) {
  const RealMatrix jacobian = problem.jacobian();
  const RealMatrix residual = problem.residual() - jacobian * problem.all_steps();
  const RealMatrix covariance =
      RealMatrix::identity(jacobian.rows()) + jacobian * problem.prior(precisions).inverse() * jacobian.transpose();
  const auto n = static_cast<double>(residual.rows());
  return -0.5 * ((n + 30) * std::log((residual.dot(covariance.inverse() * residual) + 30) / (n + 30)) +
                 covariance.log_determinant());
}

double evidence(const LocalStates& problem, const NormalEquations& normal, const VectorX& precisions) {
  const FactorisedEquations solved(normal, precisions, problem.steps, problem.local_steps);
  return log_evidence(normal, solved, precisions, problem.steps, 6 * LocalStates::blocks, problem.local_steps);
}

/// Noise and prior means of another size.
LocalStates magnified(LocalStates problem, double factor) {
  for (auto& row : problem.rows) row.residual *= factor;
  problem.steps *= factor;
  problem.local_steps *= factor;
  return problem;
}

TEST(Evidence, IsTheDensityOfTheResiduals) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const LocalStates problem =
        magnified(LocalStates(seed), seed == 4 ? 1e-3 : 1);  // far below the sensor's noise, too
    const NormalEquations normal = problem.normal_equations();
    const VectorX some = vector({0.7, 0.02, 3.0, 40.0}), others = vector({200, 15, 0.1, 3.5});
    EXPECT_NEAR(evidence(problem, normal, some), marginal(problem, some), 1e-7 * std::abs(marginal(problem, some)));
    EXPECT_NEAR(evidence(problem, normal, others) - evidence(problem, normal, some),
                marginal(problem, others) - marginal(problem, some), 1e-6);
  }
}

// A joint prior without correlations is the same as independent ones, but for its own size, which is left out.
TEST(Evidence, AJointPriorIsAPrior) {
  const LocalStates problem(5);
  const VectorX independent = VectorX::Constant(4, 0.5), none = VectorX::Zero(4);
  const NormalEquations normal = problem.normal_equations();
  NormalEquations joint = normal;
  joint.add({RealMatrix::diagonal(independent), none, 4}, problem.steps);
  const Index values = 6 * LocalStates::blocks;
  EXPECT_NEAR(log_evidence(joint, FactorisedEquations(joint, none, problem.steps, problem.local_steps), none,
                           problem.steps, values, problem.local_steps),
              log_evidence(normal, FactorisedEquations(normal, independent, problem.steps, problem.local_steps),
                           independent, problem.steps, values, problem.local_steps) -
                  2 * std::log(0.5),
              1e-8);
}

TEST(Evidence, NoSolutionHasNone) {
  const LocalStates problem(6);
  NormalEquations normal = problem.normal_equations();
  normal.matrix(1, 1) = -1e9;
  EXPECT_EQ(evidence(problem, normal, problem.precisions), -std::numeric_limits<double>::infinity());
}

/// Slope of the evidence over the logarithm of a factor on some precisions.
double slope(const LocalStates& problem, const NormalEquations& normal, const VectorX& precisions,
             const UnknownGroup& group) {
  const auto scaled = [&](double factor) {
    VectorX out = precisions;
    for (const Index k : group) out(k) *= factor;
    return evidence(problem, normal, out);
  };
  return (scaled(std::exp(1e-4)) - scaled(std::exp(-1e-4))) / 2e-4;
}

/// A problem whose unknowns are clear: steps from means of zero to values of very different sizes.
LocalStates clear_problem() {
  LocalStates problem(7);
  const RealMatrix truth = vector({3, -2, 0.05, -0.04});
  for (auto& row : problem.rows) {
    const RealMatrix changed = 0.2 * RealMatrix(row.residual) - row.dense * truth;
    for (Index k = 0; k < 6; ++k) row.residual(k) = changed(k);
  }
  problem.steps.setZero();
  problem.local_steps.setZero();
  return problem;
}

TEST(Evidence, LearnedSizesHaveNoSlopeLeft) {
  const LocalStates problem = clear_problem();
  const NormalEquations normal = problem.normal_equations();
  const std::vector<UnknownGroup> groups{{0, 1}, {2, 3}};
  const VectorX start = VectorX::Constant(4, 1);
  const VectorX learned =
      learn_priors(normal, start, problem.steps, 6 * LocalStates::blocks, groups, 60, problem.local_steps);
  for (const UnknownGroup& group : groups) {
    EXPECT_LT(std::abs(slope(problem, normal, learned, group)), 1e-3);
    EXPECT_GT(std::abs(slope(problem, normal, start, group)), 0.1);
    EXPECT_EQ(learned(group[0]), learned(group[1]));
  }
  EXPECT_GT(learned(2), 100 * learned(0));  // small values, a tight prior
}

// Of unknowns that depend on each other, with values beside the priors' means: no factor beside the best is better.
TEST(Evidence, NoNeighbourOfTheBestScaleIsBetter) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const LocalStates problem = magnified(LocalStates(seed), seed % 3 == 0 ? 0.1 : 1);
    const NormalEquations normal = problem.normal_equations();
    const VectorX start = vector({0.1, 2, 30, 0.5});
    const UnknownGroup group{0, 2, 3};
    const VectorX found =
        scale_priors(normal, start, problem.steps, 6 * LocalStates::blocks, group, problem.local_steps);
    EXPECT_EQ(found(1), start(1));  // not of the group
    EXPECT_DOUBLE_EQ(found(3) / start(3), found(0) / start(0));
    const double reached = evidence(problem, normal, found);
    for (const double towards : {std::sqrt(2.0), std::sqrt(0.5)}) {
      VectorX beside = found;
      for (const Index k : group) beside(k) *= towards;
      if (beside(0) / start(0) > 1e9) continue;  // no factor is larger
      EXPECT_LE(evidence(problem, normal, beside), reached + 1e-9) << seed << ' ' << found(0) / start(0);
    }
  }
}

TEST(Evidence, PriorsStayWhereNothingCouldBeSolved) {
  const LocalStates problem(6);
  NormalEquations normal = problem.normal_equations();
  normal.matrix(1, 1) = -1e9;
  const VectorX precisions = vector({1, 2, 700, 600});
  const Index values = 6 * LocalStates::blocks;
  EXPECT_EQ(scale_priors(normal, precisions, problem.steps, values, {0, 2}, problem.local_steps), precisions);
  EXPECT_EQ(learn_priors(normal, precisions, problem.steps, values, {{0, 2}}, 5, problem.local_steps), precisions);
}

/// Unknowns each with a row of its own, a weight for its column and a residual; one row more for a rest.
struct SingleRows {
  std::vector<double> weights, residuals;
  double rest = 0;

  NormalEquations normal() const {
    const auto n = static_cast<Index>(weights.size());
    const auto evaluate = [&](Index first, Index count, RowBlock* out) {
      for (Index b = 0; b < count; ++b) {
        out[b].residual.setZero();
        out[b].dense = Rows6::Zero(6, n);
        out[b].factor.resize(6, 0);
        out[b].unwhiten.setIdentity();
        if (first + b == n) {
          out[b].residual(0) = rest;
          continue;
        }
        const auto k = static_cast<std::size_t>(first + b);
        out[b].residual(2) = residuals[k];
        out[b].dense(2, first + b) = weights[k];
      }
    };
    return NormalEquations(BlockSystem{n + 1, n + 1, n, {}, evaluate});
  }
};

// Two unknowns by hand: the sum of squares at its minimum, and what is left to determine the noise, are those of the
// measurements and of thirty values of the sensor.
TEST(Evidence, OfTwoUnknownsByHand) {
  const NormalEquations normal = SingleRows{{2, 1}, {3, -1}, 5}.normal();
  const auto of = [&](const VectorX& precisions, const VectorX& steps, Index values) {
    return log_evidence(normal, FactorisedEquations(normal, precisions, steps), precisions, steps, values);
  };
  // at present 9 + 1 + 25 + 3 * 0.04 + 0.5; slopes 6 + 0.6 and -1 - 0.5; curvatures 7 and 1.5
  const double least = 35.62 - 6.6 * 6.6 / 7 - 1.5 * 1.5 / 1.5;
  EXPECT_NEAR(of(vector({3, 0.5}), vector({0.2, -1}), 20),
              -0.5 * (50 * std::log((least + 30) / 50) + std::log(7 * 1.5) - std::log(1.5)), 1e-9);
  // without priors both rows are met, and two values are gone; one is left at least
  const auto unpenalised = [](double freedom) { return -0.5 * (freedom * std::log(55 / freedom) + std::log(4)); };
  const VectorX none = VectorX::Zero(2);
  EXPECT_NEAR(of(none, none, 20), unpenalised(48), 1e-9);
  EXPECT_NEAR(of(none, none, 3), unpenalised(31), 1e-9);
  EXPECT_NEAR(of(none, none, 1), unpenalised(31), 1e-9);
}

// Values z that are known well, in units of the noise: evidence wants them to have the size that they have, precisions
// of 1 / z^2. On a grid of factors of sqrt(2), from 1e-6 to 1e9.
TEST(Evidence, ScalesPriorsToTheSizeOfTheUnknowns) {
  for (const std::size_t count : {1u, 2u, 260u}) {  // few, and more than are scaled by their distribution
    const NormalEquations normal =
        SingleRows{std::vector<double>(count, 1e7), std::vector<double>(count, 0), std::sqrt(1e6)}.normal();
    const auto n = static_cast<Index>(count);
    const VectorX precisions = VectorX::Constant(n, 4);
    UnknownGroup group;
    for (Index k = 0; k < n; ++k) group.push_back(k);
    const auto factor = [&](double size) {
      // the noise's variance is one: a million values, as many squares, and those of the priors
      return scale_priors(normal, precisions, VectorX::Constant(n, size), 1000000, group)(n - 1) / 4;
    };
    const auto expect = [&](double power) {
      EXPECT_NEAR(std::log2(factor(0.5 * std::pow(2, -power / 2))), power, 1e-9) << count;
    };
    expect(4.5);
    if (count == 260) continue;
    for (const double power : {0.0, 0.5, 1.0, 27.0, -1.5, -6.0, -18.5}) expect(power);
    EXPECT_NEAR(std::log2(factor(1e6)), std::log2(1e-6) + 0.25, 0.25);
    EXPECT_NEAR(std::log2(factor(1e-9)), std::log2(1e9) - 0.25, 0.25);
  }
}

// One step of the iteration by hand, of two groups: the number of unknowns that the data determine, times the variance
// of the noise, over the squares of the group.
TEST(Evidence, AStepOfTheLearningByHand) {
  const NormalEquations normal = SingleRows{{std::sqrt(3), 2, 1}, {0, 0, 0}, 6}.normal();
  const VectorX precisions = vector({1, 4, 2}), steps = vector({1, -0.5, 2});
  // curvatures 4, 8, 3: the unknowns move to 3/4, -0.25 and 2/3
  const double least = 36 + 1 + 1 + 8 - 1.0 / 4 - 4.0 / 8 - 16.0 / 3;
  const auto learned = [&](int iterations, const std::vector<UnknownGroup>& groups) {
    return RealMatrix(learn_priors(normal, precisions, steps, 70, groups, iterations));
  };
  const double variance = (least + 30) / 100;
  const double first = 0.75 + 0.5, squares = 0.75 * 0.75 + 4 * 0.25 * 0.25;  // determined; of both
  const double last = 1.0 / 3, square = 2 * 4.0 / 9;
  const RealMatrix once = learned(1, {{0, 1}, {2}});
  const double factor = first * variance / squares, other = last * variance / square;
  EXPECT_LT((once - vector({factor, 4 * factor, 2 * other})).norm(), 1e-9);
  EXPECT_EQ(learned(0, {{0, 1}, {2}}), RealMatrix(precisions));
  const VectorX after = once;
  EXPECT_LT((learned(2, {{0, 1}, {2}}) - learn_priors(normal, after, steps, 70, {{0, 1}, {2}}, 1)).norm(), 1e-9);
  EXPECT_EQ(learned(3, {{1}})(2), 2);
}

// Ten times more or less in a step, up to 1e9; unknowns that hardly anything determines count as a thousandth of one.
TEST(Evidence, LearningGoesInBoundedSteps) {
  const auto learned = [](const SingleRows& rows, const VectorX& precisions, const VectorX& steps) {
    const NormalEquations normal = rows.normal();
    std::vector<UnknownGroup> groups;
    for (Index k = 0; k < steps.size(); ++k) groups.push_back({k});
    return RealMatrix(learn_priors(normal, precisions, steps, 970, groups, 1));
  };
  const double rest = std::sqrt(970);
  EXPECT_LT((learned({{1e3, 1e3}, {0, 0}, rest}, vector({1, 2}), vector({100, 1e-4})) - vector({0.1, 20})).norm(),
            1e-9);
  EXPECT_EQ(learned({{1e3}, {0}, rest}, vector({5e8}), vector({1e-9}))(0), 1e9);
  // a weight of 1e-4 beside a prior of 1, and a best value of 223: it moves to 0.0223, at a cost of 5
  const double z = 223e-4 / 1.0001, variance = (1000 + 223 * 223e-4 / 1.0001) / 1000;
  EXPECT_NEAR(learned({{1e-2}, {-2.23}, rest}, vector({1}), vector({0}))(0), 1e-3 * variance / (z * z), 1e-6);
}

}  // namespace
}  // namespace vernier::evidence_test
