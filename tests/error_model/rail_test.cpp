// SPDX-License-Identifier: BSD-3-Clause
// An arm on a rail of 3 m: what is straight stays so, what is bent is found.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "gauss_newton.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::rail_test {
namespace {

using vernier_test::identify_by_gauss_newton;

using Chain = DhChain<7>;
constexpr double length = 3;  // [m]

Chain arm_on_rail() {
  std::array<DhRow, 7> rows;
  rows[0] = {.alpha = std::numbers::pi / 2, .joint = JointType::prismatic};
  const auto arm = robots::abb_irb120().chain;
  for (int i = 0; i < 6; ++i) rows[static_cast<std::size_t>(i) + 1] = arm.row(i);
  return Chain::from_rows(rows);
}

/// Where the carriage stands on a rail that sags, with its slope, and leaves its line by a third of that sideways.
Isometry3 carriage(double q, double bend) {
  const double u = q / length;
  const double sag = bend * 4 * u * (1 - u), slope = bend * 4 * (1 - 2 * u) / length;
  const double aside = bend / 3 * std::sin(std::numbers::pi * u),
               yaw = bend / 3 * std::numbers::pi / length * std::cos(std::numbers::pi * u);
  return rigid_motion(exp_so3(Vector3(-slope, yaw, 0)), Vector3(aside, sag, 0));
}

/// @param errors of the joints; none: they do not err
Dataset<7> measured(Index poses, double bend, std::uint64_t seed, std::optional<std::uint64_t> errors = {}) {
  const Chain links = with_geometric_errors(arm_on_rail(), {}, 5);
  const WithJointErrors<Chain> actual =
      errors ? WithJointErrors<Chain>(links, draw_joint_errors(arm_on_rail(), {}, *errors))
             : WithJointErrors<Chain>(links);
  const Isometry3 base = FrameParameters(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}).isometry(),
                  tool = FrameParameters(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5}).isometry();
  Rng rng(seed);
  JointRows<7> joints(poses, 7);
  PointRows positions(poses, 3), orientations(poses, 3);
  for (Index i = 0; i < poses; ++i) {
    joints(i, 0) = rng.uniform(0, length);
    for (int j = 1; j < 7; ++j) joints(i, j) = rng.uniform(-1.2, 1.2);
    const JointVector<7> q = configuration(joints, i);
    const Isometry3 behind = Eigen::Translation3d(0, 0, q(0) + links.row(0).d) * Isometry3::Identity();
    const Isometry3 pose = base * behind * carriage(q(0), bend) * behind.inverse() * actual.pose(q) * tool;
    for (int k = 0; k < 3; ++k) {
      positions(i, k) = pose.translation()(k) + 0.03e-3 * rng.normal();
      orientations(i, k) = 0.05e-3 * rng.normal();
    }
    set_point(orientations, i, log_so3(Matrix3(pose.linear() * exp_so3(point(orientations, i)))));
  }
  return Dataset<7>(joints, positions, orientations).without_approach();
}

/// Mean error at 100 other poses [m], and whether the rail was found to be bent.
std::pair<double, bool> outcome(double bend) {
  const Dataset<7> data = measured(150, bend, 1), fresh = measured(100, bend, 2);
  const SensorModel squared{.loss = Loss::squared};
  const Framed<Chain> nominal(arm_on_rail(), FrameParameters(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}),
                              FrameParameters(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5}));
  const auto start = identify_by_gauss_newton(nominal, data, {.frames = Frames::base_and_tool}, squared);
  const auto found = fit_error_model(
      start, data,
      {.harmonics = 0, .down = Vector3(0, 1, 0), .hysteresis = false, .drift = false, .num_validation_poses = 75},
      squared);
  double sum = 0;
  for (Index i = 0; i < fresh.size(); ++i) sum += (found.model().position(fresh.joints(i)) - fresh.position(i)).norm();
  return {sum / static_cast<double>(fresh.size()),
          found.model().identified().model().joint_errors().terms().straightness.has_value()};
}

TEST(Rail, StraightStaysStraight) {
  const auto [error, bent] = outcome(0);
  EXPECT_LT(error, 0.06e-3);  // of which the sensor has 0.048
  EXPECT_FALSE(bent);
}

// Joint functions that are missing look like a bend: the two are told apart where both are in the model.
TEST(Rail, StraightStaysStraightIfJointsErr) {
  const SensorModel squared{.loss = Loss::squared};
  const Framed<Chain> nominal(arm_on_rail(), FrameParameters(Vector6{0.4, -0.3, 0.2, 0.3, -0.4, 0.6}),
                              FrameParameters(Vector6{0.02, -0.05, 0.11, 0.2, -0.1, 0.5}));
  const Dataset<7> data = measured(240, 0, 1, 1);
  const auto start = identify_by_gauss_newton(nominal, data, {.frames = Frames::base_and_tool}, squared);
  const auto found = fit_error_model(
      start, data, {.find_lines = false, .down = Vector3(0, 1, 0), .hysteresis = false, .drift = false}, squared);
  const JointTerms& terms = found.model().identified().model().joint_errors().terms();
  EXPECT_FALSE(terms.straightness.has_value());
  EXPECT_TRUE(terms.gear_ratio || terms.size() > terms.num_dense_terms());
}

TEST(Rail, BentIsFound) {
  const auto [error, bent] = outcome(0.3e-3);
  EXPECT_LT(error, 0.07e-3);
  EXPECT_TRUE(bent);
}

}  // namespace
}  // namespace vernier::rail_test
