// SPDX-License-Identifier: BSD-3-Clause
// The blocks of code of docs/robot_files.md.
#include <gtest/gtest.h>

#include "vernier/io.hpp"
#include "vernier/kinematics/in_controller_joints.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::robot_files_page_test {
namespace {

TEST(RobotFilesPage, JointsOfTheController) {
  MatrixX pendant_joints(1, 6);
  pendant_joints << 0, 0.5, -0.2, 0, 0.7, 0;
#include "robot_files_1.inc"
  EXPECT_DOUBLE_EQ(chain_joints(0, 2), -0.3);  // joint 3 from the horizontal
  EXPECT_TRUE(arm.arm.pose(chain_joints.row(0).transpose()).isApprox(pose, 1e-15));
}

}  // namespace
}  // namespace vernier::robot_files_page_test
