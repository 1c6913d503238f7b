// SPDX-License-Identifier: BSD-3-Clause
// Several reflectors on one flange: one base, one arm, and a tool for each.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "ur10_measured.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/evaluation/position_errors.hpp"

namespace vernier::reflectors_test {
namespace {

using namespace vernier_test::ur10_measured;

constexpr MeasurementNoise positions{.position = 0.03e-3, .with_orientations = false};

const std::array<Isometry3, 3> tools{tool, FrameParameters(Vector6{-0.09, 0.05, 0.12, 0, 0.1, 0}).isometry(),
                                     FrameParameters(Vector6{0.04, -0.1, 0.09, 0, 0.1, 0}).isometry()};

/// The arm with one of the reflectors.
Actual arm_with(std::size_t reflector) {
  const Actual arm = actual_arm();
  return Actual(arm.model(), base, tools[reflector]);
}

CalibrateOptions options() {
  CalibrateOptions out;
  out.remainder.on_error_model = false;
  out.errors.drift = out.errors.hysteresis = false;  // there is none
  return out;
}

/// Rows of all reflectors, measured in turn, or all at each configuration.
Measurements<6> measured(const JointRows<6>& joints, std::uint64_t seed, bool in_turn) {
  Measurements<6> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Dataset<6> all = measure(arm_with(k), joints, positions, seed + k);
    std::vector<Index> rows;
    for (Index i = 0; i < all.size(); ++i)
      if (!in_turn || i % 3 == static_cast<Index>(k)) rows.push_back(i);
    out.add(all.rows(rows), {}, "the tracker", std::string(1, static_cast<char>('a' + k)));
  }
  return out;
}

/// Mean error of a calibrated arm at fresh configurations, of one of the reflectors [m].
double error_of(const Calibration<Chain>& found, std::size_t reflector) {
  return prediction_error(found.model(reflector), measure(arm_with(reflector), joints(300, 77), {}, 0)).mean;
}

// 180 configurations, each measured by one of three reflectors, against 180 with one reflector: three times the poses
// of each. Mean errors at 300 fresh configurations over two sets of configurations, of the first reflector. Six more
// unknowns of 36 cost 6 / (3 x 180 - 36) of the variance, about 1 %; 10 % are allowed for chance.
TEST(Reflectors, InTurnAreAsAccurateAsOneWithThreeTimesThePoses) {
  double in_turn = 0, one = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const JointRows<6> q = joints(180, 100 + seed);
    in_turn += error_of(calibrate(robot.chain, measured(q, 10 * seed, true), options()), 0) / 2;
    one += error_of(calibrate(robot.chain, measure(arm_with(0), q, positions, 10 * seed), options()), 0) / 2;
  }
  EXPECT_LT(in_turn, 1.1 * one);
  EXPECT_LT(in_turn, 0.1e-3);
}

TEST(Reflectors, HaveOneBaseAndTheirOwnOffsets) {
  const Calibration<Chain> found = calibrate(robot.chain, measured(joints(60, 5), 7, false), options());
  const auto& models = found.errors.models();
  ASSERT_EQ(models.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(models[k].identified().base().matrix(), models[0].identified().base().matrix()) << k;
    // the errors of the last link, up to 1 mm, are those of all offsets alike
    const Vector3 relative = models[k].identified().tool().translation() - models[0].identified().tool().translation();
    const Vector3 actual = tools[k].translation() - tools[0].translation();
    EXPECT_LT((relative - actual).norm(), 0.3e-3) << k;
    EXPECT_LT(error_of(found, k), 0.12e-3) << k;
  }
}

// Points of one configuration are one pose: left out together, and counted once.
TEST(Reflectors, OfOneConfigurationAreOnePose) {
  const Measurements<6> all = measured(joints(40, 3), 9, false);
  const detail::CalibrationProblem problem(
      ArmParameterisation(std::vector<ArmGeometry>(3, ArmGeometry(arm_with(0).around(robot.chain))), {}), all.sets(),
      Loss::squared);
  EXPECT_EQ(problem.num_validation_blocks(), 120);
  EXPECT_EQ(problem.num_validation_poses(), 40);
}

// With all three at each configuration the orientation of the flange is measured, too: few configurations suffice.
TEST(Reflectors, OfOneConfigurationAreBetterThanOneOfThem) {
  double three = 0, one = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const JointRows<6> q = joints(25, 200 + seed);
    three += error_of(calibrate(robot.chain, measured(q, 10 * seed, false), options()), 0);
    one += error_of(calibrate(robot.chain, measure(arm_with(0), q, positions, 10 * seed), options()), 0);
  }
  EXPECT_LT(three, 0.9 * one);
}

// A drifting base drifts for all reflectors alike: the drift is one, of all rows in their order.
TEST(Reflectors, ShareTheDriftOfTheirBase) {
  Measurements<6> all = measured(joints(120, 4), 2, true);
  detail::CalibrationProblem problem(
      ArmParameterisation(std::vector<ArmGeometry>(3, ArmGeometry(arm_with(0).around(robot.chain))), {}), all.sets(),
      Loss::squared);
  problem.start_drift(40);
  EXPECT_EQ(problem.system().local_states, 4);  // 120 rows: three intervals
  EXPECT_EQ(problem.drift_steps().size(), 24);
  for (const SessionDrift& drift : problem.drift) EXPECT_EQ(drift.knots.cols(), 4);
}

}  // namespace
}  // namespace vernier::reflectors_test
