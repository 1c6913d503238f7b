// SPDX-License-Identifier: BSD-3-Clause
// The arm's configuration that a program states, and the joint values that a controller takes for it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "vernier/kinematics/all_branches.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/robot_programs/configuration.hpp"

namespace vernier::robot_configuration_test {
namespace {

using enum ProgramLanguage;
constexpr double degree = std::numbers::pi / 180;

JointVector<6> degrees(double a, double b, double c, double d, double e, double f) {
  return JointVector<6>{a, b, c, d, e, f} * degree;
}

TEST(UpdatedConfiguration, QuadrantsOfRapid) {
  const std::vector<int> stated{0, -1, 1, 4};
  EXPECT_EQ(updated_configuration(rapid, stated, degrees(10, 0, 0, -10, 5, 100)), stated);
  EXPECT_EQ(updated_configuration(rapid, stated, degrees(0, 0, 0, -90, 5, 180)), stated);
  EXPECT_EQ(updated_configuration(rapid, stated, degrees(-0.01, 0, 0, 0.01, 5, 89.9)), (std::vector<int>{-1, 0, 0, 4}));
  EXPECT_EQ(updated_configuration(rapid, stated, degrees(91, 0, 0, -91, 5, -271)), (std::vector<int>{1, -2, -4, 4}));
}

TEST(UpdatedConfiguration, TurnBitsOfKrl) {
  const std::vector<int> stated{2, 2};  // A2 negative
  EXPECT_EQ(updated_configuration(krl, stated, degrees(1, -90, 90, 1, 30, 1)), stated);
  EXPECT_EQ(updated_configuration(krl, stated, degrees(-1.9, 1.9, 90, -1.9, 30, 0)), stated);  // within 2 degrees of 0
  EXPECT_EQ(updated_configuration(krl, stated, degrees(-2.1, 2.1, 90, 0, 30, -3)), (std::vector<int>{2, 1 + 32}));
}

TEST(UpdatedConfiguration, LastTurnNumberOfFanuc) {
  const std::vector<int> stated{0, 1, 1, 0, 0, 0};
  EXPECT_EQ(updated_configuration(fanuc_tp, stated, degrees(0, 0, 0, 0, -90, 179)), stated);
  EXPECT_EQ(updated_configuration(fanuc_tp, stated, degrees(0, 0, 0, 0, -90, 181)),
            (std::vector<int>{0, 1, 1, 0, 0, 1}));
  EXPECT_EQ(updated_configuration(fanuc_tp, stated, degrees(0, 0, 0, 0, -90, -181)),
            (std::vector<int>{0, 1, 1, 0, 0, -1}));
  EXPECT_EQ(updated_configuration(fanuc_tp, stated, degrees(0, 0, 0, 0, -90, 539)).back(), 1);
  EXPECT_EQ(updated_configuration(fanuc_tp, stated, degrees(0, 0, 0, 0, -90, 541)).back(), 2);
}

TEST(UpdatedConfiguration, OfTwoDegreesAndNotMore) {
  const std::vector<int> stated{2, 2};
  EXPECT_EQ(updated_configuration(krl, stated, degrees(-1.995, 1.995, 90, 0, 30, 0)), stated);
  EXPECT_EQ(updated_configuration(krl, stated, degrees(-2.005, 2.005, 90, 0, 30, 0)), (std::vector<int>{2, 1}));
}

TEST(UpdatedConfiguration, NoneStaysNone) {
  for (const ProgramLanguage language : {rapid, krl, urscript, fanuc_tp})
    EXPECT_TRUE(updated_configuration(language, {}, degrees(100, -200, 10, 200, -30, 300)).empty());
}

/// In degrees, within limits of 400.
double chosen_turn(ProgramLanguage language, const std::vector<int>& configuration, int joint, double angle,
                   double limit = 400) {
  return detail::stated_turn(language, configuration, joint, angle * degree, std::nan(""), -limit * degree,
                             limit * degree) /
         degree;
}

TEST(ChosenTurnWhiteBox, IsTheNearestToZeroOrTheOneThatIsStated) {
  EXPECT_NEAR(chosen_turn(urscript, {}, 0, 200), -160, 1e-9);
  EXPECT_NEAR(chosen_turn(urscript, {}, 0, -200), 160, 1e-9);
  EXPECT_NEAR(chosen_turn(fanuc_tp, {0, 1, 1, 0, 0, 1}, 5, -10), 350, 1e-9);
  EXPECT_NEAR(chosen_turn(fanuc_tp, {0, 1, 1, 0, 0, -1}, 5, 10), -350, 1e-9);
}

TEST(ChosenTurnWhiteBox, TolerancesOfWhatIsStated) {
  EXPECT_NEAR(chosen_turn(krl, {2, 0}, 0, -1.995, 180), -1.995, 1e-9);
  EXPECT_TRUE(std::isnan(chosen_turn(krl, {2, 0}, 0, -2.005, 180)));
  EXPECT_NEAR(chosen_turn(rapid, {1, 0, 0, 0}, 0, 89.951), 89.951, 1e-9);
  EXPECT_TRUE(std::isnan(chosen_turn(rapid, {1, 0, 0, 0}, 0, 89.949)));
}

class ControllerJointsOfIrb120 : public testing::Test {
 protected:
  ControllerJoints found(const JointVector<6>& at, const std::vector<int>& configuration,
                         const JointVector<6>& near = JointVector<6>::Constant(std::nan(""))) const {
    return controller_joints(roots_, robot_.chain, robot_.limits, rapid, {}, robot_.chain.pose(at), configuration,
                             near);
  }

  Robot<6> robot_ = robots::abb_irb120();
  ClosedForm<6> roots_{robot_.chain};
};

TEST_F(ControllerJointsOfIrb120, AsStated) {
  const JointVector<6> q = degrees(10, 20, -30, 40, 50, 300);
  const ControllerJoints as_stated = found(q, {0, 0, 3, 0});
  ASSERT_TRUE(as_stated.joints) << as_stated.reason;
  EXPECT_LT((*as_stated.joints - q).norm(), 1e-9);
  // another turn of joint 6, and the other side of the wrist
  EXPECT_LT((*found(q, {0, 0, -1, 0}).joints - degrees(10, 20, -30, 40, 50, -60)).norm(), 1e-9);
  EXPECT_LT((*found(q, {0, -2, 1, 1}).joints - degrees(10, 20, -30, -140, -50, 120)).norm(), 1e-9);
  EXPECT_EQ(found(q, {1, 0, 3, 0}).reason, "no joint values within the limits have its configuration");
}

TEST_F(ControllerJointsOfIrb120, FlagOfTheBranchChoosesWhereQuadrantsDoNot) {
  // Of this pose, elbow up and elbow down have the same quadrants.
  const JointVector<6> q = degrees(5, -20, 60, 10, 40, 10);
  int chosen = 0;
  for (int cfx = 0; cfx < 8; ++cfx) {
    const ControllerJoints one = found(q, {0, 0, 0, cfx});
    if (one.joints && (*one.joints - q).norm() < 1e-9) ++chosen;
  }
  EXPECT_GE(chosen, 1);
  EXPECT_LT((*found(q, {0, 0, 0, 0}).joints - q).norm(), 1e-9);
}

TEST_F(ControllerJointsOfIrb120, QuadrantsAtTheirEnd) {
  const JointVector<6> q = degrees(0.0, 20, -30, 40, 50, 90);
  for (const int cf1 : {0, -1})
    for (const int cf6 : {0, 1}) {
      const ControllerJoints one = found(q, {cf1, 0, cf6, 0});
      ASSERT_TRUE(one.joints) << one.reason;
      EXPECT_LT((*one.joints - q).norm(), 1e-9);
    }
}

TEST_F(ControllerJointsOfIrb120, WithoutConfigurationTheNearest) {
  const JointVector<6> q = degrees(10, 20, -30, 40, 50, 200);
  EXPECT_EQ(found(q, {}).reason, "no configuration, and no joint values before it are known");
  EXPECT_LT((*found(q, {}, degrees(15, 25, -20, 30, 60, 190)).joints - q).norm(), 1e-9);
  const ControllerJoints far = controller_joints(roots_, robot_.chain, robot_.limits, urscript, {},
                                                 Isometry3(Eigen::Translation3d(3, 0, 0)), {}, q);
  EXPECT_FALSE(far.joints);
  EXPECT_FALSE(far.reason.empty());
}

// Near the joint values for which makers state no flags there are none; turned over, the wrist's is set.
TEST_F(ControllerJointsOfIrb120, FlagsOfKukaAndFanuc) {
  JointLimits<6> limits;
  limits.lower.setConstant(-350 * degree);
  limits.upper.setConstant(350 * degree);
  const JointVector<6> unknown = JointVector<6>::Constant(std::nan(""));
  const auto apart = [&](ProgramLanguage language, const std::vector<int>& configuration, const JointVector<6>& q) {
    const ControllerArm arm{.negative_noflip = false};
    const ControllerJoints one =
        controller_joints(roots_, robot_.chain, limits, language, arm, robot_.chain.pose(q), configuration, unknown);
    return one.joints ? (*one.joints - q).norm() : 1e9;
  };
  EXPECT_LT(apart(krl, {2, 0b000010}, degrees(10, -80, 80, 5, 20, 10)), 1e-9);
  EXPECT_LT(apart(krl, {6, 0b111010}, degrees(10, -80, 80, -175, -20, -170)), 1e-9);
  EXPECT_GT(apart(krl, {3, 0b000010}, degrees(10, -80, 80, 5, 20, 10)), 0.1);  // from behind
  EXPECT_GT(apart(krl, {0, 0b000010}, degrees(10, -80, 80, 5, 20, 10)), 0.1);  // with the other elbow
  EXPECT_LT(apart(fanuc_tp, {0, 1, 1, 0, 0, 0}, degrees(5, 3, 2, 5, 20, 10)), 1e-9);
  EXPECT_LT(apart(fanuc_tp, {1, 1, 1, 0, 0, 0}, degrees(5, 3, 2, -175, -20, -170)), 1e-9);
  EXPECT_GT(apart(fanuc_tp, {1, 1, 1, 0, 0, 0}, degrees(5, 3, 2, 5, 20, 10)), 0.1);
}

// The quadrants leave one branch, so a wrong flag of it does not matter; where they leave two, it decides or nothing
// does.
TEST_F(ControllerJointsOfIrb120, FlagsThatContradictTheQuadrants) {
  const JointVector<6> q = degrees(10, 20, -30, 40, 50, 300);
  for (const int cfx : {0, 4, 5, 7}) {
    const ControllerJoints one = found(q, {0, 0, 3, cfx});
    ASSERT_TRUE(one.joints) << one.reason;
    EXPECT_LT((*one.joints - q).norm(), 1e-9) << cfx;
  }
  const ControllerJoints two = found(degrees(5, 40, -80, 10, 40, 10), {0, 0, 0, 7});
  EXPECT_FALSE(two.joints);
  EXPECT_EQ(two.reason, "several joint values have its configuration");
}

TEST_F(ControllerJointsOfIrb120, OutOfReachIsToldAsTheBranchesTellIt) {
  const Isometry3 far(Eigen::Translation3d(3, 0, 0));
  const JointVector<6> near = degrees(10, 20, -30, 40, 50, 200);
  const std::string told =
      all_branches(roots_, robot_.chain, far, BranchOptions<6>{.limits = robot_.limits}).describe();
  for (const std::vector<int>& configuration : {std::vector<int>{}, std::vector<int>{0, 0, 0, 0}})
    EXPECT_EQ(controller_joints(roots_, robot_.chain, robot_.limits, rapid, {}, far, configuration, near).reason, told);
}

// Joint values before with a wrist that the limits forbid: of all others the nearest, found by comparing them.
TEST_F(ControllerJointsOfIrb120, WithoutTheBranchBeforeTheNearestOfTheOthers) {
  const JointVector<6> q = degrees(10, 20, -30, 40, 50, 100), near = degrees(-165, -65, -25, 40, 5, -40);
  JointLimits<6> limits;
  limits.lower.setConstant(-350 * degree);
  limits.upper.setConstant(350 * degree);
  limits.lower(4) = -120 * degree;
  limits.upper(4) = 0;
  const Isometry3 pose = robot_.chain.pose(q);
  double least = 1e9, second = 1e9;
  JointVector<6> expected = near;
  for (const Branch<6>& branch :
       all_branches(roots_, robot_.chain, pose, BranchOptions<6>{.limits = limits, .close_to = near})) {
    if (!branch.within_limits) continue;
    const double apart = (branch.joints - near).cwiseAbs().maxCoeff();
    if (apart < least) {
      second = least;
      least = apart;
      expected = branch.joints;
    } else {
      second = std::min(second, apart);
    }
  }
  ASSERT_LT(second, 1e8);  // there is a choice
  ASSERT_GT(second - least, 1e-3);
  const ControllerJoints one = controller_joints(roots_, robot_.chain, limits, urscript, {}, pose, {}, near);
  ASSERT_TRUE(one.joints) << one.reason;
  EXPECT_LT((*one.joints - expected).norm(), 1e-9);
  limits.lower(4) = -1e-3;
  EXPECT_EQ(controller_joints(roots_, robot_.chain, limits, urscript, {}, pose, {}, near).reason,
            "beyond the limits of the joints");
}

// A branch that is farther away, but the one of the joint values before, is kept.
TEST_F(ControllerJointsOfIrb120, WithoutConfigurationTheBranchIsKept) {
  const JointVector<6> q = degrees(10, 20, -30, 80, 50, 100), near = degrees(10, 20, -30, -70, 5, 250);
  const ControllerJoints one =
      controller_joints(roots_, robot_.chain, robot_.limits, urscript, {}, robot_.chain.pose(q), {}, near);
  ASSERT_TRUE(one.joints) << one.reason;
  EXPECT_GT((*one.joints)(4), 0);
}

TEST(ControllerArms, OfFanucHaveANegativeFifthJointWhereTheConfigurationIsN) {
  EXPECT_TRUE(ControllerArm{}.negative_noflip);
}

// What makers say of their arms: ABB's cfx 0 is in front of axis 1 and of the lower arm with axis 5 positive; KUKA's
// home position (0, -90, 90, 0, 0, 0) has S 2, and bit 2 where A5 is negative.
TEST(StatedBranch, BitsOfTheLanguages) {
  for (int cfx = 0; cfx < 8; ++cfx) {
    const int branch = detail::stated_branch(rapid, {0, 0, 0, cfx});
    EXPECT_EQ((branch & 1) != 0, cfx >= 4);
    EXPECT_EQ((branch & 2) != 0, cfx % 4 >= 2);
    EXPECT_EQ((branch & 4) != 0, cfx % 2 == 1);
  }
  EXPECT_EQ(detail::stated_branch(krl, {2, 2}), 0);
  EXPECT_EQ(detail::stated_branch(krl, {6, 50}), 4);
  EXPECT_EQ(detail::stated_branch(krl, {0, 0}), 2);
  EXPECT_EQ(detail::stated_branch(krl, {3, 0}), 1);
  EXPECT_EQ(detail::stated_branch(krl, {18, 2}), 0);  // bit 4 is another matter
  EXPECT_EQ(detail::stated_branch(fanuc_tp, {0, 1, 1, 0, 0, 0}), 0);
  EXPECT_EQ(detail::stated_branch(fanuc_tp, {1, 1, 1, 0, 0, 0}), 4);
  EXPECT_EQ(detail::stated_branch(fanuc_tp, {0, 0, 1, 0, 0, 0}), 2);
  EXPECT_EQ(detail::stated_branch(fanuc_tp, {0, 1, 0, 0, 0, 0}), 1);
}

}  // namespace
}  // namespace vernier::robot_configuration_test
