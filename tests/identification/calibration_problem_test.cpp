// SPDX-License-Identifier: BSD-3-Clause
// The rows of a calibration problem: residuals, their derivatives, and joint readings that are not exact.

#include "vernier/identification/detail/calibration_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calibration_problems.hpp"
#include "random_blocks.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::calibration_problem_test {
namespace {

using namespace vernier_test::calibration_problems;
using vernier_test::difference;
using vernier_test::random_vector;
using vernier_test::RealMatrix;
TEST(CalibrationProblemWhiteBox, ResidualIsModelMinusMeasuredInSigmas) {
  const Measured measured(8);
  const Problem problem = measured.problem(0, 1e-3);
  ASSERT_EQ(problem.num_blocks(), 12);
  EXPECT_EQ(problem.measured_values(), 8 * 6 + 4 * 3);
  RowBlock rows;
  for (Index b = 0; b < 12; ++b) {
    problem(b, 1, &rows);
    const bool first = b < 8;
    const Dataset<6>& data = first ? measured.first : measured.second;
    const Index i = first ? b : b - 8;
    const RealMatrix joints = RealMatrix(data.joints(i)).transpose();
    const Isometry3 pose = problem.arm.poses(first ? 0 : 1, joints).front();
    const double sigma = first ? 0.03e-3 : 0.05e-3;
    const Vector3 position = (translation(pose) - data.position(i)) / sigma;
    EXPECT_LT((three(rows.residual, 0) - position).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(rows.position_sigma, sigma);
    EXPECT_EQ(RealMatrix(rows.unwhiten), RealMatrix::identity(6));
    if (first) {
      const Vector3 turn = three(pose_difference(pose, data.pose(i)), 3) / 0.1e-3;
      EXPECT_LT((three(rows.residual, 3) - turn).norm(), 1e-9);
    } else {
      const auto below = [](const RealMatrix& six_rows) { return six_rows.block(3, 0, 3, six_rows.cols()).largest(); };
      EXPECT_EQ(below(rows.residual), 0);
      EXPECT_EQ(below(rows.dense), 0);
      EXPECT_EQ(below(rows.factor), 0);
    }
  }
}

TEST(CalibrationProblemWhiteBox, RowsAreCentralDifferences) {
  const Measured measured(8);
  const Problem problem = measured.problem(0, 1e-3);
  const Index size = problem.arm.size();
  ASSERT_EQ(size, 12 + 36 + 6 + 5 + 21 + 6 + 4 + 0 + 2 + 4 + 24);
  constexpr double step = 0.03;  // of a size: rounding and curvature both stay below 1e-8
  std::vector<RealMatrix> analytic, numeric(12, RealMatrix(6, size));
  RowBlock rows;
  for (Index b = 0; b < 12; ++b) analytic.push_back(expanded(problem, b, rows));
  for (Index k = 0; k < size; ++k) {
    Problem above = problem, below = problem;
    above.arm.move(step_of(k, size, step));
    below.arm.move(step_of(k, size, -step));
    for (std::size_t b = 0; b < 12; ++b) {
      above(static_cast<Index>(b), 1, &rows);
      const RealMatrix high = rows.residual;
      below(static_cast<Index>(b), 1, &rows);
      numeric[b].set_block(0, k, (high - rows.residual) / (2 * step));
    }
  }
  const auto names = problem.arm.names();
  for (std::size_t b = 0; b < 12; ++b)
    for (Index k = 0; k < size; ++k)
      for (const int part : {0, 3}) {
        const RealMatrix a = analytic[b].block(part, k, 3, 1), n = numeric[b].block(part, k, 3, 1);
        EXPECT_LT((a - n).norm(), 1e-7 * (1 + n.norm())) << "pose " << b << ", " << names[static_cast<std::size_t>(k)];
      }
  // every geometric unknown is seen, those of a station's base from there alone
  for (Index k = 0; k < 48; ++k) {
    double first = 0, second = 0;
    for (std::size_t b = 0; b < 12; ++b) (b < 8 ? first : second) += analytic[b].col(k).norm();
    EXPECT_EQ(first > 0, k >= 12 || k % 2 == 0) << k;
    EXPECT_EQ(second > 0, k >= 12 ? k < 45 : k % 2 == 1) << k;  // positions do not see how the tool is turned
  }
}

TEST(CalibrationProblemWhiteBox, JointNoiseWhitensWhatItAdds) {
  const Measured measured(8);
  constexpr double sigma = 0.2e-3;
  const Problem exact = measured.problem(0, 1e-3), noisy = measured.problem(sigma, 1e-3);
  RowBlock a, b;
  for (Index i = 0; i < exact.num_blocks(); ++i) {
    exact(i, 1, &a);
    noisy(i, 1, &b);
    const RealMatrix factor = a.factor, unwhiten = b.unwhiten;
    const RealMatrix covariance = RealMatrix::identity(6) + sigma * sigma * factor * factor.transpose();
    EXPECT_LT((unwhiten * unwhiten.transpose() - covariance).norm(), 1e-12 * covariance.norm());
    const auto expect_unwhitened = [&](const RealMatrix& whitened, const RealMatrix& wanted) {
      EXPECT_LT((unwhiten * whitened - wanted).norm(), 1e-12 * wanted.norm());
    };
    expect_unwhitened(b.residual, a.residual);
    expect_unwhitened(b.dense, a.dense);
    expect_unwhitened(b.factor, a.factor);
    EXPECT_EQ(difference(b.functions, a.functions), 0);
    EXPECT_EQ(b.position_sigma, a.position_sigma);
  }
}

TEST(CalibrationProblemWhiteBox, ErrorsInVariablesAreThoseOfTheFullSparseSystem) {
  const Measured measured(30);
  constexpr double sigma = 0.2e-3;  // moves a pose by as much as the sensor errs, and more
  const Problem exact = measured.problem(0, 0.1e-3), noisy = measured.problem(sigma, 0.1e-3);
  const Index p = exact.arm.size(), n = exact.num_blocks(), all = p + 6 * n;
  const RealMatrix steps = noisy.arm.steps(), precisions = noisy.arm.precisions();
  const NormalEquations normal(noisy.system()), of_exact(exact.system());
  const FactorisedEquations reduced(normal, precisions, steps);
  ASSERT_TRUE(reduced.usable());
  const FactorisedEquations without(of_exact, precisions, steps);
  const RealMatrix step = reduced.step(), of_exact_joints = without.step();
  ASSERT_GT((step - of_exact_joints).norm(), 0.1 * of_exact_joints.norm());  // joint noise matters here

  // unknowns: those of the arm, then six joint errors a pose in units of sigma
  RealMatrix matrix(all, all), gradient(all, 1);
  const double ridge = 1e-12 * RealMatrix(normal.matrix).diagonal().largest();  // as in the reduced system
  matrix.set_block(0, 0, RealMatrix::diagonal(precisions) + ridge * RealMatrix::identity(p));
  gradient.set_block(0, 0, precisions.times(steps));
  RowBlock rows;
  for (Index b = 0; b < n; ++b) {
    const RealMatrix own = expanded(exact, b, rows), joint = sigma * RealMatrix(rows.factor);
    const Index at = p + 6 * b;
    matrix.add_block(0, 0, own.transpose() * own);
    matrix.set_block(at, 0, joint.transpose() * own);
    matrix.set_block(0, at, own.transpose() * joint);
    matrix.set_block(at, at, RealMatrix::identity(6) + joint.transpose() * joint);
    gradient.add_block(0, 0, own.transpose() * rows.residual);
    gradient.set_block(at, 0, joint.transpose() * rows.residual);
  }
  const RealMatrix wanted = -matrix.solve_by_cholesky(gradient).block(0, 0, p, 1);
  EXPECT_LT((step - wanted).norm(), 1e-8 * wanted.norm());
}

TEST(CalibrationProblemWhiteBox, DistancesAreAlongTheLineOfSight) {
  const Robot<6> robot = robots::ur10();
  const Framed<Chain> arm(robot.chain, FrameParameters(Vector6{1, -2, 0.4, 0.1, 0.2, -0.5}),
                          FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}));
  const auto data = measure_distances(arm, Vector3::Zero(), sample_joints(robot.limits, 53, 1), 1e-2, 3);
  const auto problem_of = [&](const Framed<Chain>& at) {
    std::vector<GeometricUnknown> unknowns;
    for (Index k = 0; k < arm.parameters().size(); ++k) unknowns.push_back({k, -1, 1e-3, 0});
    return Problem(ArmParameterisation({ArmGeometry(at)}, unknowns),
                   {vernier_test::set_of(data, {.distance_sigma = 1e-4})}, Loss::squared);
  };
  const detail::StackedRows exact = problem_of(arm).stacked(true);
  ASSERT_EQ(exact.residuals.size(), 53);
  for (Index k = 0; k < arm.parameters().size(); ++k) {
    auto p = arm.parameters();
    p(k) += 1e-6;
    const RealMatrix up = problem_of(arm.with_parameters(p)).stacked(false).residuals;
    p(k) -= 2e-6;
    const RealMatrix down = problem_of(arm.with_parameters(p)).stacked(false).residuals;
    EXPECT_LT(difference(RealMatrix(exact.jacobian).col(k), (up - down) / 2e-6 * 1e-3), 1e-6) << k;
  }
}

TEST(CalibrationProblemWhiteBox, EachPoseHasATemperatureOfItsOwn) {
  Measured measured(8);
  const VectorX celsius{{20, 21, 23, 26, 30, 35, 41, 48}};
  measured.first = measured.first.at_temperatures(celsius);
  ArmParameterisation arm({ArmGeometry(Framed<Chain>(measured.robot.chain, Measured::start_base(0), measured.tool))},
                          {{11, -1, 1e-3, 0}, {11, -1, 1e-3, 0, true}});
  Problem problem(std::move(arm), {vernier_test::set_of(measured.first, {})}, Loss::squared);
  problem.reference_temperature = 25;
  std::array<RowBlock, 4> rows;
  problem(3, 4, rows.data());
  for (Index i = 0; i < 4; ++i) {
    const Rows6& dense = rows[static_cast<std::size_t>(i)].dense;
    EXPECT_GT(dense.col(0).norm(), 1);
    EXPECT_LT((dense.col(1) - (celsius(3 + i) - 25) * dense.col(0)).norm(), 1e-9) << i;
  }
}

TEST(CalibrationProblemWhiteBox, TemperaturesOfAllStations) {
  Measured measured(8);
  const auto found = [&] { return measured.problem(0, 1e-3).temperatures(); };
  EXPECT_EQ(found().std, 0);
  measured.first = measured.first.at_temperatures(VectorX{{20, 22, 20, 22, 20, 22, 20, 22}});
  EXPECT_EQ(found().std, 0);  // the second station has none
  EXPECT_EQ(found().mean, 0);
  measured.second = measured.second.at_temperatures(VectorX{{24, 24, 24, 18}});
  // mean 258 / 12; squares 4 x 2.25 + 4 x 0.25 + 3 x 6.25 + 12.25
  EXPECT_NEAR(found().mean, 21.5, 1e-12);
  EXPECT_NEAR(found().std, std::sqrt(41.0 / 12), 1e-12);
  EXPECT_EQ(found().range, (std::array<double, 2>{18, 24}));
}

// Undamped and with priors: x - (J'J + P)^-1 (J'r + P x).
TEST(CalibrationProblemWhiteBox, OneIterationIsAGaussNewtonStep) {
  const Measured measured(30);
  Problem problem = measured.problem(0, 1e-3);
  const RealMatrix before = problem.arm.steps(), precisions = RealMatrix::diagonal(problem.arm.precisions());
  const detail::StackedRows rows = problem.stacked(true);
  const RealMatrix jacobian = rows.jacobian, transposed = jacobian.transpose();
  const RealMatrix step = (transposed * jacobian + precisions)
                              .solve_by_cholesky(-(transposed * RealMatrix(rows.residuals)) - precisions * before);
  EXPECT_FALSE(problem.solve(1));
  EXPECT_LT((RealMatrix(problem.arm.steps()) - before - step).norm(), 1e-6 * step.norm());
}

// Tool and base turned far from where they are: steps that make residuals larger are taken back.
TEST(CalibrationProblemWhiteBox, FarStartsConverge) {
  const Robot<6> robot = robots::abb_irb120();
  const Framed<Chain> actual(robot.chain, Measured::start_base(0), FrameParameters(Vector6{0.1, -0.2, 0.3, 0, 0, 0}));
  const Dataset<6> data =
      measure(actual, sample_joints(robot.limits, 40, 21), {.position = 0.05e-3, .with_orientations = false}, 22);
  std::vector<GeometricUnknown> unknowns;
  for (Index k = 0; k < 6; ++k) unknowns.push_back({k, -1, k < 3 ? 1e-3 : 1e-2, 0});
  for (Index k = 36; k < 39; ++k) unknowns.push_back({k, -1, 1e-3, 0});
  Rng rng(23);
  int converged = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Vector6 off = Vector6(Measured::start_base(0).values());
    for (double& x : off) x += rng.uniform(-3, 3);
    Problem problem(ArmParameterisation({ArmGeometry(Framed<Chain>(robot.chain, FrameParameters(off), {}))}, unknowns),
                    {vernier_test::set_of(data, {.position_sigma = 0.05e-3})}, Loss::squared);
    const bool ended = problem.solve(60);
    const double rms = RealMatrix(problem.stacked(false).residuals).norm() / std::sqrt(120.0);
    converged += ended && rms < 1.2;
  }
  EXPECT_EQ(converged, 20);
}

/// Starts far from the solution, so that some first steps fail; positions that may drift.
struct FarStart {
  Robot<6> robot = robots::abb_irb120();
  Dataset<6> data;
  FarStart()
      : data(measure(
                 Framed<Chain>(robot.chain, Measured::start_base(0), FrameParameters(Vector6{0.1, -0.2, 0.3, 0, 0, 0})),
                 sample_joints(robot.limits, 24, 21), {.position = 0.05e-3, .with_orientations = false}, 22)
                 .measured_at(VectorX::LinSpaced(24, 0, 230))) {}

  /// @param precision of the priors of all unknowns, about values they have left
  Problem problem(std::uint64_t seed, Loss loss, double precision) const {
    std::vector<GeometricUnknown> unknowns;
    for (Index k = 0; k < 6; ++k) unknowns.push_back({k, -1, k < 3 ? 1e-3 : 1e-2, precision});
    for (Index k = 36; k < 39; ++k) unknowns.push_back({k, -1, 1e-3, precision});
    Rng rng(seed);
    Vector6 off = Vector6(Measured::start_base(0).values());
    for (double& x : off) x += rng.uniform(-3, 3);
    ArmParameterisation arm({ArmGeometry(Framed<Chain>(robot.chain, FrameParameters(off), {}))}, unknowns);
    arm.move(random_vector(rng, 9, 30));
    return {std::move(arm), {vernier_test::set_of(data, {.position_sigma = 0.05e-3})}, loss};
  }
};

/// Weighted squares of residuals, and what priors add.
double cost_of(const Problem& problem) {
  const RealMatrix steps = problem.arm.steps(), drift = problem.drift_steps();
  double out = RealMatrix(problem.stacked(false).residuals).squared_norm() +
               RealMatrix(problem.arm.precisions()).dot(steps.times(steps));
  if (problem.prior) out += steps.dot(RealMatrix(problem.prior->precision) * steps);  // its mean is zero here
  for (const LocalPrior& of_two : problem.drift_priors()) {
    const RealMatrix one = drift.block(6 * of_two.first, 0, 6, 1), other = drift.block(6 * of_two.second, 0, 6, 1);
    out += (of_two.first == of_two.second ? 1 : 2) * one.dot(RealMatrix(of_two.precision) * other);
  }
  return out;
}

// A step that fails is taken back: of the arm, of the drift, and the weights of the loss. It fails where residuals and
// priors together grow. The last of some steps is not checked, so one more iteration shows what becomes of it.
TEST(CalibrationProblemWhiteBox, AStepThatFailsIsTakenBack) {
  const FarStart far;
  int failed = 0;
  for (const std::uint64_t seed : {0, 5, 11})
    for (const Loss loss : {Loss::squared, Loss::huber})
      for (const int priors : {0, 1, 2}) {  // none, of each unknown, of all
        constexpr double precision = 1e6;
        Problem start = far.problem(seed, loss, priors == 1 ? precision : 0);
        if (priors == 2) start.prior = JointPrior{precision * RealMatrix::identity(9), VectorX::Zero(9), 1};
        start.start_drift(6);
        Problem before = start;
        for (int n = 1; n < 8; ++n) {
          if (loss != Loss::squared) before.reweight();
          Problem after = start, next = start;
          if (after.solve(n)) break;
          if (cost_of(after) > 1.0001 * cost_of(before)) {
            ++failed;
            EXPECT_FALSE(next.solve(n + 1));
            EXPECT_EQ(RealMatrix(next.arm.steps()), RealMatrix(before.arm.steps())) << seed << ", " << n;
            EXPECT_EQ(RealMatrix(next.drift_steps()), RealMatrix(before.drift_steps())) << seed << ", " << n;
            EXPECT_EQ(RealMatrix(next.stacked(false).residuals), RealMatrix(before.stacked(false).residuals)) << seed;
            break;
          }
          before = after;
        }
      }
  EXPECT_EQ(failed, 12);
}

/// Norms of unweighted residuals of a block: position or distance, orientation.
std::array<double, 2> norms_of(const Problem& problem, Index block) {
  const RealMatrix residual = residual_of(problem, block);
  return {residual.block(0, 0, 3, 1).norm(), residual.block(3, 0, 3, 1).norm()};
}

TEST(CalibrationProblemWhiteBox, MeasuredPositionsValidateWhereThereAreAny) {
  const WithWire both(16);
  EXPECT_EQ(both.problem(Loss::squared).num_blocks(), 16 + 21);
  EXPECT_EQ(both.problem(Loss::squared).num_validation_blocks(), 16);
  EXPECT_EQ(both.problem(Loss::squared, false).num_validation_blocks(), 21);
}

// Thresholds follow from the median of each kind of residual: 2.8 standard deviations for three components, 1.345 for a
// single number.
TEST(CalibrationProblemWhiteBox, ThresholdsAndWeightsByKind) {
  const WithWire both(17);
  Problem problem = both.problem(Loss::cauchy);
  std::array<std::vector<double>, 3> kinds;  // positions, orientations, distances
  std::vector<std::array<double, 2>> norms;
  for (Index b = 0; b < 38; ++b) {
    norms.push_back(norms_of(problem, b));
    kinds[b < 17 ? 0 : 2].push_back(norms.back()[0]);
    if (b < 17) kinds[1].push_back(norms.back()[1]);
  }
  std::array<double, 3> expected{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::sort(kinds[k].begin(), kinds[k].end());
    expected[k] = kinds[k][kinds[k].size() / 2] * (k == 2 ? 1.345 / 0.6745 : 2.8 / 1.538);
    EXPECT_NEAR(problem.thresholds()[k], expected[k], 1e-9 * expected[k]) << k;
  }
  const double unweighted = problem.normal_equations().cost;
  const std::array<double, 2> sums = problem.reweight();
  EXPECT_NEAR(sums[0], unweighted, 1e-9 * unweighted);
  double weighted = 0;
  for (Index b = 0; b < 38; ++b) {
    const auto now = norms_of(problem, b), before = norms[static_cast<std::size_t>(b)];
    for (std::size_t part = 0; part < (b < 17 ? 2u : 1u); ++part) {
      const double ratio = before[part] / expected[b < 17 ? part : 2], weight = 1 / (1 + ratio * ratio);
      EXPECT_NEAR(now[part] * now[part], weight * before[part] * before[part], 1e-9 * before[part] * before[part]) << b;
      weighted += weight * before[part] * before[part];
    }
  }
  EXPECT_NEAR(sums[1], weighted, 1e-9 * weighted);
  // weights are those of unweighted residuals, however often
  const std::array<double, 2> again = problem.reweight();
  EXPECT_NEAR(again[0], weighted, 1e-9 * weighted);
  EXPECT_NEAR(again[1], weighted, 1e-9 * weighted);
}

// Where the weighted residuals are least, under the weights of these residuals.
TEST(CalibrationProblemWhiteBox, ARobustLossIsReweightedUntilItConverges) {
  const WithWire both(60);
  Problem problem = both.problem(Loss::cauchy);
  ASSERT_TRUE(problem.solve(60));
  problem.reweight();
  const NormalEquations normal = problem.normal_equations();
  for (Index k = 0; k < 2; ++k)
    EXPECT_LT(normal.gradient(k) * normal.gradient(k) / normal.matrix(k, k), 2e-5 * normal.cost) << k;
}

// Priors with correlations count by their own precision, beside the rows.
TEST(CalibrationProblemWhiteBox, APriorWithCorrelationsIsAdded) {
  const WithWire both(8);
  Problem problem = both.problem(Loss::squared);
  problem.arm.move(RealMatrix(2, 1, {3, -1}));
  const NormalEquations without = problem.normal_equations();
  const RealMatrix precision(2, 2, {4, 1, 1, 2}), centre(2, 1, {0.5, 0.25}), off(2, 1, {2.5, -1.25});
  problem.prior = JointPrior{precision, centre, 1};
  const NormalEquations with = problem.normal_equations();
  EXPECT_LT(difference(with.matrix, RealMatrix(without.matrix) + precision), 1e-9 * without.matrix.norm());
  EXPECT_LT(difference(with.gradient, RealMatrix(without.gradient) + precision * off), 1e-9 * without.gradient.norm());
  EXPECT_NEAR(with.cost, without.cost + off.dot(precision * off), 1e-9 * without.cost);
}

}  // namespace
}  // namespace vernier::calibration_problem_test
