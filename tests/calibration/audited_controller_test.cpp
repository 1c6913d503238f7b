// SPDX-License-Identifier: BSD-3-Clause
// The map of a controller's joints, named by an audit of poses that were read without it.
#include "vernier/calibration/data_audit.hpp"

#include <gtest/gtest.h>

#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::audited_controller_test {
namespace {

/// Poses of an arm whose joints are written as a controller shows them, and read as those of the chain.
DataAudit audit(const Robot<6>& robot, const ControllerMap& shown_by) {
  const JointRows<6> chain = 0.8 * sample_joints(robots::abb_irb120().limits, 80, 3);
  const auto measured = measure(with_geometric_errors(robot.chain, {}, 4), chain, {.position = 3e-5});
  const JointRows<6> shown = shown_by.to_controller(chain);
  return audit_data(robot.chain, Measurements<6>(Dataset<6>(shown, measured.positions(), measured.orientations())));
}

TEST(AuditedController, NamesSignsAndTheCouplingOfAFanucArm) {
  const auto robot = robots::fanuc_r2000ib_165f();
  const auto found = audited_controller(audit(robot, robot.controller), {}, 6);
  ASSERT_TRUE(found.has_value());
  // the signs of joints 4 and 6, and of joint 1 with the sensor's frame, are told by orientations
  EXPECT_EQ(found->formulas(std::vector<JointType>(6, JointType::revolute)),
            (std::vector<std::string>{"J1", "J2", "-J2 - J3", "-J4", "-J5", "-J6"}));
}

TEST(AuditedController, FollowsAMapThatIsWrongInOneSign) {
  const auto robot = robots::kuka_kr6_r900();
  DataAudit found;
  found.findings.push_back({FaultKind::joint_sign, 2, {}, 0, ""});
  const auto map = audited_controller(found, robot.controller, 6);
  ASSERT_TRUE(map.has_value());
  EXPECT_EQ(map->formulas(std::vector<JointType>(6, JointType::revolute)),
            (std::vector<std::string>{"-J1", "J2", "-J3", "-J4", "J5", "-J6"}));
}

TEST(AuditedController, NoneWithoutSuchAFault) {
  DataAudit found;
  found.findings.push_back({FaultKind::outlier, -1, {3}, 0.01, ""});
  EXPECT_FALSE(audited_controller(found, {}, 6).has_value());
}

}  // namespace
}  // namespace vernier::audited_controller_test
