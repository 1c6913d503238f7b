// SPDX-License-Identifier: BSD-3-Clause
// The program of the README, on data that are simulated into the folder where it runs.

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "README_blocks.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/error_sources.hpp"
#include "vernier/simulation/sampling.hpp"

namespace vernier::readme_test {
namespace {

static_assert(README_blocks == 1, "a block of README.md without a test");

TEST(Readme, ProgramCalibratesAndCorrects) {
  const Robot<6> robot = robots::ur10();
  JointLimits<6> range;
  range.lower = JointVector<6>(-2.5, -2.6, 0.3, -2.5, -2, -2.5);
  range.upper = JointVector<6>(2.5, -0.6, 2.4, 2.5, 2, 2.5);
  const auto off = with_geometric_errors(robot.chain, {}, 4);
  const auto errors = draw_joint_errors(robot.chain, {.gear_ratio = 0, .coupling = 0}, 5);
  const Framed real(WithJointErrors<DhChain<6>>(off, errors), FrameParameters(Vector6{2, -1, 0.5, 0.1, -0.2, 1.5}),
                    FrameParameters(Vector6{0.02, 0.03, 0.11, 0, 0.1, 0}));
  const vernier_test::TemporaryFolder folder("readme");
  write_dataset<6>((folder / "poses.csv").string(),
                   measure(real, sample_joints(range, 250, 1), {.position = 0.03e-3, .with_orientations = false}, 2));

  const auto run = vernier_test::run_command("cd '" + folder.path().string() + "' && '" + VERNIER_README_PROGRAM + "'",
                                             folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto held_out = run.output.find("held out: "), command = run.output.find("send joint 1 to ");
  ASSERT_NE(held_out, std::string::npos) << run.output;
  ASSERT_NE(command, std::string::npos) << run.output;
  double millimetres = 0, radians = 0;
  ASSERT_EQ(std::sscanf(run.output.c_str() + held_out, "held out: %lf mm", &millimetres), 1);
  ASSERT_EQ(std::sscanf(run.output.c_str() + command, "send joint 1 to %lf rad", &radians), 1);
  EXPECT_GT(millimetres, 0.02);  // the noise of the poses themselves
  EXPECT_LT(millimetres, 0.15);
  const double largest = range.upper(0) + 0.05;
  EXPECT_LT(std::abs(radians), largest);
  EXPECT_FALSE(std::filesystem::is_empty(folder.path() / "model.json"));
}

}  // namespace
}  // namespace vernier::readme_test
