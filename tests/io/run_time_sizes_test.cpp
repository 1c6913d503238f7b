// SPDX-License-Identifier: BSD-3-Clause
// Joint values for calibrated robots in vectors whose size is known at run time only: those that fit are taken, others
// are refused in every build, before Eigen converts them.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "vernier/io/calibrated_robot.hpp"
#include "vernier/kinematics/robots.hpp"

namespace calibrated_robot_sizes_test {
using namespace vernier;
using vernier_test::complaint;
using Chain = DhChain<6>;

const Robot<6> irb120 = robots::abb_irb120();
const CalibratedRobot<6> arm("an arm", ErrorModel<Chain>(irb120.chain, Framed(WithJointErrors<Chain>(irb120.chain))),
                             irb120.limits, {});
const VectorX six = VectorX::LinSpaced(6, 0.1, 0.6), two = VectorX::Constant(2, 0.1);
const JointVector<6> fixed = six;
const Isometry3 target = arm.pose(fixed);
const std::string refusal = "2 joint values for an arm of 6 joints";

template <class Arm>
void expect_sizes_checked(const Arm& now) {
  EXPECT_EQ(now.pose(six).matrix(), now.pose(fixed).matrix());
  EXPECT_EQ(now.position(six), now.position(fixed));
  EXPECT_EQ(now.jacobian(six), now.jacobian(fixed));
  EXPECT_EQ(now.pose_and_jacobian(six).jacobian, now.jacobian(fixed));
  EXPECT_EQ(now.gate(six), now.gate(fixed));
  EXPECT_EQ(complaint([&] { now.pose(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.position(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.jacobian(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.pose_and_jacobian(two); }), refusal);
  EXPECT_EQ(complaint([&] { now.gate(two); }), refusal);
}

TEST(CalibratedRobotsOfRunTimeSizes, ThoseThatFitAreTakenOthersRefused) {
  expect_sizes_checked(arm);
  expect_sizes_checked(arm.approached_from(fixed));
  expect_sizes_checked(arm.approached_from(six));
  EXPECT_EQ(arm.predict(six).matrix(), arm.predict(fixed).matrix());
  EXPECT_EQ(complaint([] { arm.predict(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.approached_from(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.radii_95(MatrixX::Zero(3, 2)); }), refusal);
}

TEST(CalibratedRobotsOfRunTimeSizes, Corrections) {
  const JointVector<6> command = arm.correct(fixed, fixed).command;
  EXPECT_EQ(arm.correct(six).command, arm.correct(fixed).command);
  EXPECT_EQ(arm.correct(six, fixed).command, command);
  EXPECT_EQ(arm.correct(fixed, six).command, command);
  EXPECT_EQ(arm.correct(six, six).command, command);
  EXPECT_EQ(arm.correct(target, six).command, arm.correct(target, fixed).command);
  EXPECT_EQ(arm.correct(target, six, six).command, arm.correct(target, fixed, fixed).command);
  EXPECT_EQ(complaint([] { (void)arm.correct(two); }), refusal);
  EXPECT_EQ(complaint([] { (void)arm.correct(two, fixed); }), refusal);
  EXPECT_EQ(complaint([] { (void)arm.correct(fixed, two); }), refusal);
  EXPECT_EQ(complaint([] { (void)arm.correct(target, two); }), refusal);
  EXPECT_EQ(complaint([] { (void)arm.correct(target, two, fixed); }), refusal);
  EXPECT_EQ(complaint([] { (void)arm.correct(target, fixed, two); }), refusal);
}

static_assert(noexcept(arm.pose(fixed)) && noexcept(arm.correct(fixed, fixed)) && noexcept(arm.gate(fixed)));

}  // namespace calibrated_robot_sizes_test
