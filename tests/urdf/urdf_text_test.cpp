// SPDX-License-Identifier: BSD-3-Clause
// Arms that no URDF file describes, written as one.
#include "vernier/urdf/urdf_text.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier::urdf_text_test {
namespace {

/// The largest entry in which two arms differ over random joint values.
double difference(const ArmGeometry& a, const ArmGeometry& b) {
  Rng rng(5);
  MatrixX q(50, a.joints());
  for (Index i = 0; i < q.size(); ++i) q(i) = rng.uniform(-3, 3);
  const auto first = a.poses(q), second = b.poses(q);
  double worst = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    worst = (std::max)(worst, (first[i].matrix() - second[i].matrix()).cwiseAbs().maxCoeff());
  return worst;
}

TEST(UrdfText, IsTheArm) {
  int kinds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(VERNIER_ROBOT_FILES)) {
    const RobotDescription robot = load_robot(entry.path().string());
    const UrdfChain chain = parse_urdf(urdf_text(robot), "plain.urdf");
    EXPECT_EQ(chain.robot.name, robot.name);
    EXPECT_EQ(chain.robot.joint_types(), robot.joint_types());
    EXPECT_LT(difference(robot.geometry(), chain.robot.geometry()), 1e-12) << entry.path();
    ++kinds;
  }
  EXPECT_GE(kinds, 10);
}

TEST(UrdfText, KeepsNamesFramesAndLimits) {
  RobotDescription robot = RobotDescription::of(robots::abb_irb120());
  robot.name = "a < b & \"c\"";
  robot.joint_names = {"a1", "a2", "a3", "a4", "a5", "a6"};
  robot.base = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Vector3::UnitX());
  robot.tool = Eigen::Translation3d(0.1, 0, 0.2) * Eigen::AngleAxisd(-0.4, Vector3::UnitY());
  robot.limits[1].second = std::numeric_limits<double>::infinity();
  const UrdfChain chain = parse_urdf(urdf_text(robot), "plain.urdf");
  EXPECT_EQ(chain.robot.name, robot.name);
  EXPECT_EQ(chain.robot.joint_names, robot.joint_names);
  EXPECT_LT(difference(robot.geometry(), chain.robot.geometry()), 1e-12);
  EXPECT_EQ(chain.robot.limits[0], robot.limits[0]);
  EXPECT_TRUE(std::isinf(chain.robot.limits[1].first));  // continuous
  EXPECT_EQ(chain.joints.back(), "tool_joint");
  EXPECT_EQ(chain.moving.back() + 2, static_cast<int>(chain.joints.size()));  // which may take a tool
}

TEST(UrdfText, LimitsAreThoseThatTheControllerAllows) {
  const RobotDescription robot = load_robot(std::string(VERNIER_ROBOT_FILES) + "/fanuc.json");
  const UrdfChain chain = parse_urdf(urdf_text(robot), "plain.urdf");
  // its third joint is -J2 - J3
  EXPECT_NEAR(chain.robot.limits[2].first, -robot.limits[1].second - robot.limits[2].second, 1e-15);
  EXPECT_NEAR(chain.robot.limits[2].second, -robot.limits[1].first - robot.limits[2].first, 1e-15);
}

TEST(UrdfText, RefusesAJointThatSlidesWithoutEnd) {
  RobotDescription robot = load_robot(std::string(VERNIER_ROBOT_FILES) + "/rail.json");
  robot.limits[0].first = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(vernier_test::complaint([&] { static_cast<void>(urdf_text(robot)); }),
            "urdf_text: joint 1 slides and has no limits, which a URDF file needs");
  robot.limits.pop_back();
  EXPECT_EQ(vernier_test::complaint([&] { static_cast<void>(urdf_text(robot)); }),
            "urdf_text: limits of 6 joints, expected 7");
}

}  // namespace
}  // namespace vernier::urdf_text_test
