// SPDX-License-Identifier: BSD-3-Clause
// Joint values in matrices whose size is known at run time only: those that fit are taken, others are refused in every
// build, before Eigen converts them.

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/general_six_axis.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"
#include "vernier/kinematics/robots.hpp"

namespace run_time_sizes_test {
using namespace vernier;
using vernier_test::complaint;

const DhChain<6> arm = robots::abb_irb120().chain;
const Framed<DhChain<6>> framed(arm, FrameParameters(Vector6{0.1, 0.2, 0.3, 0, 0, 0}));
const VectorX six = VectorX::LinSpaced(6, 0.1, 0.6), two = VectorX::Constant(2, 0.1);
const JointVector<6> fixed = six;
const MatrixX rows = six.transpose().replicate(3, 1), narrow = MatrixX::Zero(3, 5);

TEST(RunTimeSizes, ThoseThatFitAreTaken) {
  for (const auto& [at_run_time, at_compile_time] : {std::pair{arm.pose(six), arm.pose(fixed)},
                                                     {framed.pose(six), framed.pose(fixed)},
                                                     {framed.pose_and_jacobian(six).pose, framed.pose(fixed)}})
    EXPECT_TRUE(at_run_time.isApprox(at_compile_time, 1e-14));
  EXPECT_TRUE(arm.pose(six / 2 + six / 2).isApprox(arm.pose(fixed), 1e-14));
  EXPECT_EQ(arm.position(six.head(6)), arm.position(fixed));
  EXPECT_EQ(arm.jacobian(six), arm.jacobian(fixed));
  EXPECT_EQ(arm.parameter_jacobian(six), arm.parameter_jacobian(fixed));
  EXPECT_EQ(positions(framed, rows), positions(framed, JointRows<6>(rows)));
  EXPECT_EQ(arm.positions(rows, Vector3(0, 0, 0.1)), arm.positions(JointRows<6>(rows), Vector3(0, 0, 0.1)));
  EXPECT_EQ(poses(arm, rows).size(), 3U);
  EXPECT_EQ(poses_and_jacobians(arm, rows).jacobians.cols(), 36);
  EXPECT_EQ(inverse_kinematics(arm, arm.pose(fixed), six).status, IkStatus::converged);
  EXPECT_EQ(ClosedForm(arm).roots(arm.pose(fixed), six, 0.01).count,
            ClosedForm(arm).roots(arm.pose(fixed), fixed).count);
  EXPECT_TRUE(robots::abb_irb120().limits.contains(six));
  EXPECT_EQ(robots::abb_irb120().limits.clamp(six), fixed);
}

TEST(RunTimeSizes, OthersAreRefused) {
  const std::string refusal = "2 joint values for an arm of 6 joints",
                    columns = "5 joint values for an arm of 6 joints";
  EXPECT_EQ(complaint([] { arm.pose(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.position(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.jacobian(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.pose_and_jacobian(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.parameter_jacobian(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.pose(six.head(2)); }), refusal);
  EXPECT_EQ(complaint([] { arm.pose(MatrixX(6, 2)); }), "12 joint values for an arm of 6 joints");
  EXPECT_EQ(complaint([] { framed.position(two); }), refusal);
  EXPECT_EQ(complaint([] { static_cast<void>(inverse_kinematics(arm, arm.pose(fixed), two, {.restarts = 2})); }),
            refusal);
  EXPECT_EQ(complaint([] { static_cast<void>(inverse_kinematics(arm, Vector3(0.3, 0, 0.3), two)); }), refusal);
  EXPECT_EQ(complaint([] { static_cast<void>(ClosedForm(arm).roots(arm.pose(fixed), two)); }), refusal);
  EXPECT_EQ(complaint([] { static_cast<void>(ClosedForm(arm).distances(two)); }), refusal);
  EXPECT_EQ(complaint([] { static_cast<void>(GeneralSixAxis(arm).distances(two)); }), refusal);
  EXPECT_EQ(complaint([] { robots::abb_irb120().limits.contains(two); }), refusal);
  EXPECT_EQ(complaint([] { robots::abb_irb120().limits.clamp(two); }), refusal);
  EXPECT_EQ(complaint([] { arm.positions(narrow); }), columns);
  EXPECT_EQ(complaint([] { arm.poses(narrow); }), columns);
  EXPECT_EQ(complaint([] { arm.poses_and_jacobians(narrow); }), columns);
  EXPECT_EQ(complaint([] { arm.poses_and_parameter_jacobians(narrow); }), columns);
  EXPECT_EQ(complaint([] { positions(framed, narrow); }), columns);
  EXPECT_EQ(complaint([] { poses(framed, narrow); }), columns);
}

static_assert(noexcept(arm.pose(fixed)) && noexcept(framed.pose_and_jacobian(fixed)));

}  // namespace run_time_sizes_test
