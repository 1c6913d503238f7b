// SPDX-License-Identifier: BSD-3-Clause
// A sensor of a user's own, without a change of the library: a dial gauge, which measures how far the tool point is
// along a direction, from an unknown zero. The direction is known in the designed base frame. The identified one turns
// against that, since it absorbs the zero of joint 1: so the known direction is a start, and estimated.

#include <gtest/gtest.h>

#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"
#include "vernier/testing/sensor_laws.hpp"

namespace vernier::dial_gauge_test {
namespace {

class DialGauge {
 public:
  DialGauge(Vector3 direction, VectorX readings) : direction_(direction), readings_(std::move(readings)) {}

  const char* kind() const { return "dial gauge"; }
  Index size() const { return readings_.size(); }
  Index values() const { return 1; }
  SensorSigma sigma() const { return {2e-6, 1}; }
  void sense(Index i, const Isometry3& pose, SensedRows& rows) const {
    rows = {Vector6::Zero(), Matrix6::Zero()};
    rows.residual(0) = pose.translation().z() - readings_(i);  // its frame has the direction as z axis
    rows.motion(0, 2) = 1;
  }
  /// Its zero and direction; rotations about the direction and shifts across it have no effect.
  std::array<bool, 6> unknown_frame() const { return {false, false, true, true, true, false}; }
  Isometry3 base_from(std::span<const Isometry3> poses) const {
    Isometry3 out(Eigen::Quaterniond::FromTwoVectors(direction_, Vector3::UnitZ()));
    double sum = 0;
    for (std::size_t i = 0; i < poses.size(); ++i)
      sum += readings_(static_cast<Index>(i)) - (out.linear() * poses[i].translation()).z();
    out.translation().z() = sum / static_cast<double>(poses.size());
    return out;
  }
  Plausibility plausibility() const { return {5e-3, "the dial gauge reads otherwise, by", "wrong units or zero?"}; }

 private:
  Vector3 direction_;
  VectorX readings_;
};

const auto robot = robots::ur10();
const auto actual = with_geometric_errors(robot.chain, {}, 3);
const Vector3 up(0.6, 0, 0.8);
constexpr double zero = 0.4;

JointRows<6> joints(Index n, std::uint64_t seed) { return sample_joints(robot.limits, n, seed); }
DialGauge gauge(const JointRows<6>& at) { return {up, (positions(actual, at) * up).array() + zero}; }

TEST(DialGauge, KeepsTheLawsOfSensors) {
  EXPECT_EQ(testing::sensor_violations(gauge(joints(20, 1)), poses(actual, joints(20, 1))), std::vector<std::string>());
}

TEST(DialGauge, ImprovesACalibrationAndIsNamedInItsReport) {
  const auto poses = measure(actual, joints(40, 2), {.position = 0.3e-3, .with_orientations = false}, 4);
  const JointRows<6> touched = joints(120, 5), fresh = joints(300, 6);
  const CalibrateOptions options{.errors = {.harmonics = 0, .drift = false}, .remainder = {.learners = {}}};
  const auto without = calibrate(robot.chain, poses, options);
  const auto with = calibrate(robot.chain, Measurements<6>(poses).add(touched, gauge(touched), "gauge.csv"), options);
  for (const Stage stage : {Stage::geometry, Stage::session})
    EXPECT_LT(prediction_error(with.errors.models(stage)[0], measure(actual, fresh)).mean,
              0.8 * prediction_error(without.errors.models(stage)[0], measure(actual, fresh)).mean);
  const CalibrationReport report = evaluate(with, measure(actual, fresh), robot.limits);
  ASSERT_EQ(report.others.size(), 1u);
  EXPECT_EQ(report.others[0].kind, "dial gauge");
  EXPECT_NE(report.summary().find("gauge.csv: 120 measurements (dial gauge)"), std::string::npos) << report.summary();
  try {
    (void)calibrate(robot.chain, Measurements<6>(poses).add(joints(120, 7), gauge(touched), "gauge.csv"), options);
    ADD_FAILURE() << "readings of other poses are taken";
  } catch (const CalibrationFailure& failure) {
    EXPECT_EQ(std::string(failure.what()).rfind("gauge.csv: the dial gauge reads otherwise, by ", 0), 0u);
  }
}

}  // namespace
}  // namespace vernier::dial_gauge_test
