// SPDX-License-Identifier: BSD-3-Clause
// A calibration problem whose bases, and whose joints' zeros, drift: motions, rows, priors and steps.

#include <gtest/gtest.h>

#include <cmath>

#include "calibration_problems.hpp"
#include "random_blocks.hpp"
#include "real_matrix.hpp"
#include "set_of.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier::calibration_drift_test {
namespace {

using namespace vernier_test::calibration_problems;
using vernier_test::random_vector;
using vernier_test::RealMatrix;

/// Two stations of which both drift; from no motion.
Problem drifting(Measured& measured) {
  measured.first = measured.first.measured_at(VectorX::LinSpaced(8, 0, 150));
  measured.second = measured.second.measured_at(VectorX::LinSpaced(4, 200, 270));
  Problem problem = measured.problem(0, 1e-3);
  problem.start_drift(4);  // three knots and two
  return problem;
}

TEST(CalibrationDriftWhiteBox, TheDriftToComeIsAtLeastTheExpectedOne) {
  Measured measured(8);
  measured.first = measured.first.measured_at(VectorX::LinSpaced(8, 0, 70));
  Problem problem = measured.problem(0, 1e-3);
  problem.start_drift(50);  // half of the steps in 200 poses: 15 um, 10 urad, and 5 urad of the joints
  problem.start_joint_drift();
  problem.drift_precision = 4;
  problem.joint_drift_precision = 0.25;
  VectorX variance = problem.drift_step_variance(1);
  ASSERT_EQ(variance.size(), 12);
  for (Index k = 0; k < 12; ++k) EXPECT_NEAR(variance(k), k < 3 ? 225e-12 : 100e-12, 1e-24) << k;
  problem.drift_precision = 0.25;
  variance = problem.drift_step_variance(1);
  for (Index k = 0; k < 12; ++k) EXPECT_NEAR(variance(k), k < 3 ? 900e-12 : k < 6 ? 400e-12 : 100e-12, 1e-24) << k;
  // precisions are relative to the noise: of half the stated deviation, the same random walk has a quarter of them
  problem.drift_precision = 0.0625;
  variance = problem.drift_step_variance(0.25);
  for (Index k = 0; k < 12; ++k) EXPECT_NEAR(variance(k), k < 3 ? 900e-12 : k < 6 ? 400e-12 : 25e-12, 1e-24) << k;
}

TEST(CalibrationDriftWhiteBox, RowsOfTheDriftAreCentralDifferences) {
  Measured measured(8);
  Problem problem = drifting(measured);
  problem.start_joint_drift();
  const BlockSystem system = problem.system();
  ASSERT_EQ(system.local_states, 5);
  ASSERT_EQ(system.local_size, 12);
  const double root = std::sqrt(4.0 / 200);
  RowBlock rows;
  for (Index state = 0; state < 5; ++state)
    for (Index r = 0; r < 12; ++r) {
      const double scale = root * (r < 3 ? 0.03e-3 : r < 6 ? 20e-6 : 10e-6), step = 1e-6;
      const auto moved = [&](double by) {
        Problem out = problem;
        out.drift[state < 3 ? 0 : 1].knots(r, state < 3 ? state : state - 3) += by;
        return out;
      };
      const Problem above = moved(step), below = moved(-step);
      for (Index b = 0; b < 12; ++b) {
        problem(b, 1, &rows);
        RealMatrix analytic(6, 1);
        for (const RowBlock::Local& local : rows.local)
          if (local.state == state) analytic += RealMatrix::of(local.columns).col(r);
        const RealMatrix numeric = (residual_of(above, b) - residual_of(below, b)) / (2 * step) * scale;
        EXPECT_LT((analytic - numeric).norm(), 1e-6) << "block " << b << ", knot " << state << ", row " << r;
      }
    }
}

TEST(CalibrationDriftWhiteBox, DriftMovesPosesAndTurnsTheirRows) {
  Measured measured(8);
  Problem problem = drifting(measured);
  Rng rng(18);
  for (SessionDrift& of_station : problem.drift)
    for (double& x : of_station.knots.reshaped()) x = 0.1 * rng.normal();
  const Index size = problem.arm.size();
  RowBlock rows;
  for (const Index b : {0, 3, 7, 8, 10, 11}) {
    const bool first = b < 8;
    const Dataset<6>& data = first ? measured.first : measured.second;
    const Index i = first ? b : b - 8;
    const Isometry3 pose = problem.arm.poses(first ? 0 : 1, RealMatrix(data.joints(i)).transpose()).front();
    const Isometry3 motion = problem.drift[first ? 0 : 1].motion(data.times()(i));
    EXPECT_EQ(RealMatrix(problem.drift_motion(b)), RealMatrix(motion));
    const RealMatrix analytic = expanded(problem, b, rows);
    const Vector3 off = transformed(motion, translation(pose)) - data.position(i);
    EXPECT_LT((three(rows.residual, 0) - off / (first ? 0.03e-3 : 0.05e-3)).norm(), 1e-8);
    for (Index k = 0; k < size; k += 5) {
      constexpr double step = 0.03;
      Problem above = problem, below = problem;
      above.arm.move(step_of(k, size, step));
      below.arm.move(step_of(k, size, -step));
      const RealMatrix numeric = (residual_of(above, b) - residual_of(below, b)) / (2 * step);
      for (const int part : {0, 3})
        EXPECT_LT((analytic.col(k) - numeric).block(part, 0, 3, 1).norm(),
                  1e-7 * (1 + numeric.block(part, 0, 3, 1).norm()))
            << b << ", " << k;
    }
  }
}

// Steps from knot to knot have a precision, and so, of a hundredth, have the knots.
TEST(CalibrationDriftWhiteBox, DriftIsARandomWalkNearZero) {
  Measured measured(8);
  Problem problem = drifting(measured);
  problem.start_joint_drift();
  problem.drift_precision = 4;
  problem.joint_drift_precision = 0.25;
  Rng rng(19);
  const RealMatrix x = random_vector(rng, 60);
  double wanted = 0, found = 0;
  for (Index k = 0; k < 60; ++k) {
    const double precision = k % 12 < 6 ? 4 : 0.25;
    const Index state = k / 12;
    wanted += precision * 0.01 * x(k) * x(k);
    if (state != 0 && state != 3) wanted += precision * std::pow(x(k) - x(k - 12), 2);  // states 3 and 4 are the second
  }
  for (const LocalPrior& prior : problem.drift_priors()) {
    const RealMatrix one = x.block(12 * prior.first, 0, 12, 1), other = x.block(12 * prior.second, 0, 12, 1);
    found += (prior.first == prior.second ? 1 : 2) * one.dot(RealMatrix(prior.precision) * other);
    EXPECT_GE(prior.first, prior.second);
  }
  EXPECT_NEAR(found, wanted, 1e-12 * wanted);
}

// Nothing says when positions of a station were measured, so they do not drift.
TEST(CalibrationDriftWhiteBox, PositionsWithoutTimesDoNotDrift) {
  Measured measured(8);
  measured.first = measured.first.measured_at(VectorX::LinSpaced(8, 0, 150));
  MeasuredSet timeless = vernier_test::set_of(measured.second, {});
  timeless.times.resize(0);
  const ArmGeometry arm(Framed<Chain>(measured.robot.chain));
  Problem problem(ArmParameterisation({arm, arm}, {{11, -1, 1e-3, 0}}),
                  {vernier_test::set_of(measured.first, {}), timeless}, Loss::squared);
  problem.start_drift(4);
  EXPECT_FALSE(problem.drift[0].empty());
  EXPECT_TRUE(problem.drift[1].empty());
  problem.stop_drift();
  EXPECT_EQ(problem.system().local_states, 0);
  EXPECT_TRUE(problem.drift.empty());
}

// Moves every knot by its own step.
TEST(CalibrationDriftWhiteBox, OneIterationMovesTheDriftByItsSteps) {
  Measured measured(8);
  Problem problem = drifting(measured);
  const NormalEquations normal = problem.normal_equations();
  const FactorisedEquations solved(normal, problem.arm.precisions(), problem.arm.steps(), problem.drift_steps(),
                                   eigen_sparse_solver, 0);
  ASSERT_TRUE(solved.usable());
  const RealMatrix step = solved.local_step();
  EXPECT_GT(step.norm(), 1e-3);
  EXPECT_FALSE(problem.solve(1));
  EXPECT_LT((RealMatrix(problem.drift_steps()) - step).norm(), 1e-9 * step.norm());
}

// Wires have no temperature and no drift; nor has a session without duration.
TEST(CalibrationDriftWhiteBox, TemperatureAndDriftAreThoseOfPoses) {
  WithWire both(16);
  both.measured.first = both.measured.first.at_temperatures(VectorX::LinSpaced(16, 20, 35));
  EXPECT_NEAR(both.problem(Loss::squared).temperatures().mean, 27.5, 1e-12);
  EXPECT_EQ(both.problem(Loss::squared, false).temperatures().std, 0);
  both.measured.first = both.measured.first.measured_at(VectorX::LinSpaced(16, 0, 150));
  Problem problem = both.problem(Loss::squared);
  problem.start_drift(8);
  ASSERT_EQ(problem.drift.size(), 2u);
  EXPECT_EQ(problem.drift[0].knots.cols(), 3);
  EXPECT_TRUE(problem.drift[1].empty());
  EXPECT_EQ(problem.system().local_states, 3);
  both.measured.first = both.measured.first.measured_at(VectorX::Constant(16, 5));
  Problem at_once = both.problem(Loss::squared);
  at_once.start_drift(8);
  EXPECT_TRUE(at_once.drift[0].empty());
}

TEST(CalibrationDriftWhiteBox, ZerosOfTheJointsDriftByStationUntilTheyStop) {
  Measured measured(8);
  Problem problem = drifting(measured);
  EXPECT_EQ(problem.drift_joint_zeros(9).size(), 0);
  problem.start_joint_drift();
  for (Index knot = 0; knot < 2; ++knot) problem.drift[1].knots(8, knot) = 1e-5 * static_cast<double>(1 + 2 * knot);
  for (Index i = 0; i < 4; ++i) {  // times 200, 223, 247 and 270: a third of the way each
    const VectorX zeros = problem.drift_joint_zeros(8 + i);
    ASSERT_EQ(zeros.size(), 6);
    EXPECT_NEAR(zeros(2), 1e-5 * (1 + 2.0 / 3 * static_cast<double>(i)), 1e-18) << i;
    EXPECT_EQ(zeros(1), 0);
  }
  problem.drift[1].knots(5, 1) = 7e-6;
  problem.stop_joint_drift();
  EXPECT_EQ(problem.system().local_size, 6);
  for (const SessionDrift& of_station : problem.drift) EXPECT_EQ(of_station.knots.rows(), 6);
  EXPECT_EQ(problem.drift[1].knots(5, 1), 7e-6);
  EXPECT_EQ(problem.drift_joint_zeros(9).size(), 0);
}

// Columns of the drift are whitened as all others are, and joint noise has columns of its own where no term needs them.
TEST(CalibrationDriftWhiteBox, JointNoiseWhitensTheDriftToo) {
  Measured measured(8);
  measured.first = measured.first.measured_at(VectorX::LinSpaced(8, 0, 150));
  const auto problem_of = [&](double joint_sigma) {
    ArmParameterisation arm({ArmGeometry(Framed<Chain>(measured.robot.chain, Measured::start_base(0), measured.tool))},
                            {{11, -1, 1e-3, 0}});
    Problem out(std::move(arm), {vernier_test::set_of(measured.first)}, Loss::squared, joint_sigma);
    out.start_drift(4);
    return out;
  };
  Problem exact = problem_of(0), noisy = problem_of(0.2e-3);
  noisy.joint_columns = false;
  RowBlock a, b;
  for (Index i = 0; i < 8; ++i) {
    exact(i, 1, &a);
    noisy(i, 1, &b);
    const RealMatrix factor = a.factor, unwhiten = b.unwhiten;
    ASSERT_EQ(factor.cols(), 6);
    const RealMatrix covariance = RealMatrix::identity(6) + 4e-8 * factor * factor.transpose();
    EXPECT_LT((unwhiten * unwhiten.transpose() - covariance).norm(), 1e-12 * covariance.norm());
    for (std::size_t k = 0; k < 2; ++k) {
      ASSERT_EQ(a.local[k].state, b.local[k].state);
      if (a.local[k].state < 0) continue;
      const RealMatrix plain = a.local[k].columns, whitened = b.local[k].columns;
      EXPECT_LT((unwhiten * whitened - plain).norm(), 1e-12 * plain.norm());
    }
  }
}

}  // namespace
}  // namespace vernier::calibration_drift_test
