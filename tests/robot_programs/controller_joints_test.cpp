// SPDX-License-Identifier: BSD-3-Clause
// Programs of a FANUC arm, whose joint 3 is counted from the horizontal: joint values and poses are corrected, and the
// real arm goes where the program means.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <string>

#include "branch_helpers.hpp"
#include "vernier/compensation/compensated.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/robot_programs/correct_program.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::program_controller_joints_test {
namespace {

using Joints = JointVector<6>;
using Chain = DhChain<6>;

constexpr double degree = std::numbers::pi / 180;

/// The joints of the chain, written out.
Joints chain_of(const Joints& j) { return {j(0), j(1), -(j(1) + j(2)), -j(3), -j(4), -j(5)}; }

/// A calibrated arm that is no library type.
class Arm {
 public:
  static constexpr int dof = 6;

  Arm() : made_(vernier_test::as_made(robot_.chain, rng_)) {}
  const Chain& nominal() const { return robot_.chain; }
  const Chain& made() const { return made_; }
  const JointLimits<6>& limits() const { return robot_.limits; }
  const ControllerMap& controller() const { return robot_.controller; }
  Correction<6> correct(const Isometry3& target, const Joints& seed, const Joints&) const {
    return Compensated(made_, robot_.chain).correct(target, seed);
  }

 private:
  Robot<6> robot_ = robots::fanuc_r2000ib_165f();
  Rng rng_{3};
  Chain made_;
};

/// The same arm, of which nobody said how its joints are counted.
class Unmapped : public Arm {
 public:
  void controller() const = delete;
};

std::string position(int number, const Joints& j) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "P[%d]{\n   GP1:\n\tUF : 0, UT : 1,\t\n\tJ1= %.6f deg,\tJ2= %.6f deg,\tJ3= %.6f deg,\n\tJ4= %.6f deg,\tJ5= "
      "%.6f deg,\tJ6= %.6f deg\n};\n",
      number, j(0) / degree, j(1) / degree, j(2) / degree, j(3) / degree, j(4) / degree, j(5) / degree);
  return text;
}

std::string pose_position(int number, const Isometry3& pose) {
  char text[300];
  const Vector3 zyx = detail::zyx_of_rotation(rotation(pose)) / degree;
  std::snprintf(
      text, sizeof text,
      "P[%d]{\n GP1:\n UF : 0, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n X = %.6f mm, Y = %.6f mm, Z = %.6f mm,\n W "
      "= %.7f deg, P = %.7f deg, R = %.7f deg\n};\n",
      number, 1e3 * pose(0, 3), 1e3 * pose(1, 3), 1e3 * pose(2, 3), zyx(2), zyx(1), zyx(0));
  return text;
}

RobotProgram parsed(const std::string& text) { return parse_program(ProgramLanguage::fanuc_tp, text, "part.ls"); }

const Joints first = Joints{20, -10, 15, 30, -60, 10} * degree, second = Joints{-15, 25, -20, -100, -45, 170} * degree,
             third = Joints{5, 10, -30, 0, -70, 20} * degree;
const std::string moves = "/PROG M\n/MN\n 1:J P[1] 50% FINE ;\n 2:J P[2] 50% FINE ;\n 3:J P[3] 50% FINE ;\n/POS\n";

TEST(ProgramControllerJoints, JointPositionsAndPosesAreCorrected) {
  const Arm arm;
  const Isometry3 tool = rigid_motion(exp_so3(Vector3(0, 0.3, 0)), Vector3(0.1, 0, 0.2));
  const std::string text = moves + position(1, first) + position(2, second) +
                           pose_position(3, arm.nominal().pose(chain_of(third)) * tool) + "/END\n";
  const RobotProgram program = parsed(text);
  ASSERT_EQ(program.targets.size(), 3u);
  ProgramOptions options{.arm = ControllerArm{}};
  options.tools.by_name = {{"1", tool}};
  const CorrectedProgram corrected = correct_program(program, arm, options);
  for (const Uncorrected& one : corrected.uncorrected) ADD_FAILURE() << one.line << ": " << one.reason;
  ASSERT_EQ(corrected.targets.size(), 3u);
  EXPECT_GT(corrected.mean_correction(), 0.2e-3);

  const RobotProgram again = parsed(replace_targets(text, program, corrected.replaced()));
  ASSERT_EQ(again.targets.size(), 3u);
  const Joints meant[] = {first, second, third};
  for (std::size_t k = 0; k < 3; ++k) {
    const Joints command = corrected.targets[k].replaced.joints;
    if (k < 2)
      EXPECT_LT((again.targets[k].joints - command).norm(), 1e-7);
    else  // the controller reaches the pose with the nominal arm
      EXPECT_LT(
          (arm.nominal().position(chain_of(command)) - Vector3((again.targets[k].pose * tool.inverse()).translation()))
              .norm(),
          1e-6);
    EXPECT_LT((arm.made().position(chain_of(command)) - arm.nominal().position(chain_of(meant[k]))).norm(), 1e-6);
    EXPECT_LT((command - meant[k]).cwiseAbs().maxCoeff(), 0.05);
    EXPECT_GT((command - meant[k]).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(ProgramControllerJoints, WithoutAMapJointPositionsAreRefused) {
  const RobotProgram program = parsed(moves + position(1, first) + position(2, second) + position(3, third) + "/END\n");
  const CorrectedProgram corrected = correct_program(program, Unmapped());
  ASSERT_EQ(corrected.uncorrected.size(), 3u);
  EXPECT_EQ(corrected.uncorrected[0].reason, "joint values, in which J2 and J3 depend on each other");
  EXPECT_EQ(corrected.uncorrected[0].missing, MissingInput::controller_joints);
  EXPECT_TRUE(corrected.targets.empty());
}

TEST(ProgramControllerJoints, AnIncompleteJointPositionIsListed) {
  std::string damaged = position(1, first);
  damaged.replace(damaged.find("J5="), 3, "J7=");
  const RobotProgram program = parsed("/PROG M\n/MN\n 1:J P[1] 50% FINE ;\n/POS\n" + damaged + "/END\n");
  ASSERT_EQ(program.uncorrected.size(), 1u);
  EXPECT_EQ(program.uncorrected[0].reason, "a component is missing or no number");
}

}  // namespace
}  // namespace vernier::program_controller_joints_test
