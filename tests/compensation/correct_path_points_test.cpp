// SPDX-License-Identifier: BSD-3-Clause
// What the points of a corrected path say, and what its options do.

#include "vernier/compensation/correct_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::correct_path_points_test {
namespace {

const Robot<6> robot = robots::ur10();
const JointVector<6> home{0.3, -1.2, 1.4, -0.9, 1.0, 0.2};

/// An arm whose errors are those of its geometry, measured where its first joint is negative, and hardly elsewhere.
struct MeasuredOnOneSide {
  static constexpr int dof = 6;
  DhChain<6> real = with_geometric_errors(robot.chain, {}, 1);
  const DhChain<6>& nominal() const { return robot.chain; }
  Isometry3 pose(const JointVector<6>& q) const noexcept { return real.pose(q); }
  Vector3 position(const JointVector<6>& q) const noexcept { return real.position(q); }
  Jacobian<6> jacobian(const JointVector<6>& q) const noexcept { return real.jacobian(q); }
  PoseAndJacobian<6> pose_and_jacobian(const JointVector<6>& q) const noexcept { return real.pose_and_jacobian(q); }
  double gate(const JointVector<6>& q) const noexcept { return q(0) < 0 ? 1 : 0.25; }
};
const MeasuredOnOneSide arm;

CorrectedPath<6> corrected(const std::vector<PathTarget<6>>& targets, const PathOptions<6>& options) {
  return correct_path(arm, ClosedForm<6>(robot.chain), targets, options);
}

/// A move to the pose at home, and two lines of 200 mm.
std::vector<PathTarget<6>> two_lines() {
  std::vector<PathTarget<6>> out(3, {.pose = robot.chain.pose(home), .motion = Motion::linear});
  out[0].motion = Motion::joint;
  out[1].pose.translation() += Vector3(0.2, 0, 0);
  out[2].pose.translation() += Vector3(0.2, 0.2, 0);
  return out;
}

PathOptions<6> from_home() {
  PathOptions<6> out{.limits = robot.limits};
  out.start = home;
  return out;
}

// The other branches are within a turn of home: what is not measured costs more than to go there, or less.
TEST(CorrectPath, WhereTheArmWasMeasuredChoosesTheBranch) {
  const std::vector<PathTarget<6>> target{{.pose = robot.chain.pose(home)}};
  for (const double cost : {0.1, 20.0}) {
    PathOptions<6> options = from_home();
    options.extrapolation_cost = cost;
    const PathPoint<6> point = corrected(target, options).points.front();
    EXPECT_EQ(point.status, PointStatus::met);
    EXPECT_EQ(point.command(0) < 0, cost > 1);
    EXPECT_EQ(point.gate, cost > 1 ? 1 : 0.25);
  }
}

TEST(CorrectPath, PointsSayWhatTheWholeSays) {
  PathOptions<6> options = from_home();
  options.tolerance = 5e-6;
  options.rotation_tolerance = 1;
  const CorrectedPath<6> path = corrected(two_lines(), options);
  ASSERT_GT(path.points.size(), 5u);
  double before = 0, after = 0;
  Index inserted = 0;
  for (const PathPoint<6>& point : path.points) {
    before = std::max(before, point.ends_only);
    after = std::max(after, point.deviation);
    inserted += point.inserted;
    EXPECT_LE(point.deviation, 5e-6);
    if (point.inserted) {
      EXPECT_EQ(point.ends_only, 0);
    }
  }
  EXPECT_EQ(path.before, before);
  EXPECT_EQ(path.after, after);
  EXPECT_GT(before, 2 * after);
  EXPECT_EQ(path.inserted(), inserted);
  EXPECT_EQ(inserted, static_cast<Index>(path.points.size()) - 3);
  EXPECT_EQ(path.count(PointStatus::met), 3);
}

TEST(CorrectPath, OrientationsAreKeptToATolerance) {
  PathOptions<6> options = from_home();
  options.tolerance = 1;
  options.rotation_tolerance = 1;
  options.max_joint_step = 3;
  EXPECT_EQ(corrected(two_lines(), options).inserted(), 0);
  options.rotation_tolerance = 1e-5;
  EXPECT_GT(corrected(two_lines(), options).inserted(), 2);
}

TEST(CorrectPath, WhatIsNotLearnedIsUsedInFull) {
  const CorrectedPath<6> path =
      correct_path(robot.chain, ClosedForm<6>(robot.chain), {{.pose = robot.chain.pose(home)}}, from_home());
  EXPECT_EQ(path.points.front().gate, 1);
}

TEST(CorrectPath, RefusesOptionsThatAreNotPositive) {
  const auto complaint = [](const auto& spoil) {
    PathOptions<6> options = from_home();
    spoil(options);
    return vernier_test::complaint([&] { (void)corrected(two_lines(), options); });
  };
  const std::string refused = "correct_path: tolerances and steps must be positive";
  EXPECT_EQ(complaint([](PathOptions<6>& options) { options.tolerance = 0; }), refused);
  EXPECT_EQ(complaint([](PathOptions<6>& options) { options.rotation_tolerance = 0; }), refused);
  EXPECT_EQ(complaint([](PathOptions<6>& options) { options.max_joint_step = 0; }), refused);
  EXPECT_EQ(complaint([](PathOptions<6>& options) { options.max_inserted = -1; }), refused);
  EXPECT_EQ(complaint([](PathOptions<6>& options) { options.max_inserted = 0; }), "");
}

// A limit in the way of the first joint: the command keeps to it, and says by how much the target is missed.
TEST(CorrectPath, WhatIsLeftAtALimitIsSaid) {
  PathOptions<6> options = from_home();
  options.limits.upper(0) = 0.2;
  const Isometry3 target = robot.chain.pose(home);
  const CorrectedPath<6> path = corrected({{.pose = target, .joints = home}}, options);
  const PathPoint<6>& point = path.points.front();
  EXPECT_EQ(point.status, PointStatus::beyond_limits);
  EXPECT_LE(point.command(0), 0.2);
  const Isometry3 reached = arm.pose(point.command);
  EXPECT_NEAR(point.position_error, (translation(reached) - translation(target)).norm(), 1e-12);
  EXPECT_NEAR(point.rotation_error, rotation_difference(rotation(target), rotation(reached)).norm(), 1e-12);
  EXPECT_GT(point.position_error, 1e-3);
  EXPECT_GT(point.rotation_error, 1e-3);
}

}  // namespace
}  // namespace vernier::correct_path_points_test
