// SPDX-License-Identifier: BSD-3-Clause
// Arms by the lines of their axes: which point of a line is given does not matter.
#include "vernier/kinematics/detail/closed_form_arm.hpp"

#include <gtest/gtest.h>

#include "random_chains.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::closed_form_arm_test {
namespace {

using detail::ArmKind;
using detail::SixAxes;

SixAxes arm_of(const Vector3 (&directions)[6], const Vector3 (&points)[6]) {
  SixAxes arm;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 3; ++k) {
      arm.direction(k, i) = directions[i](k);
      arm.point(k, i) = points[i](k);
    }
  }
  arm.tool = rigid_motion(exp_so3(Vector3(0.1, -0.2, 0.3)), points[5] + Vector3(0.05, 0.06, -0.07));
  return arm;
}

/// Points a billion metres out along their axes, which are parallel to those of the base so that no digit of the other
/// coordinates is lost: the roots are as exact as ever.
void expect_exact_with_points_far_out(const SixAxes& arm, std::initializer_list<int> far_out, ArmKind kind) {
  SixAxes far = arm;
  for (const int i : far_out)
    for (int k = 0; k < 3; ++k) far.point(k, i) += 1e9 * far.direction(k, i);
  const detail::ClosedFormArm form(far, 1e-6);
  ASSERT_EQ(form.kind(), kind);
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Isometry3 target = pose_of(arm, vernier_test::random_joints<6>(rng));
    const auto roots = form.solve(target, JointVector<6>::Zero(), 0);
    int met = 0;
    for (const auto& root : roots) {
      if (root.margin > 0) continue;
      ++met;
      EXPECT_LT(pose_difference(target, pose_of(arm, root.joints)).norm(), 1e-10);
    }
    EXPECT_GE(met, 2);
  }
}

TEST(ClosedFormArmWhiteBox, PointsMayLieAnywhereOnParallelAxes) {
  const Vector3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const SixAxes three = arm_of(
      {z, y, y, y, z, y}, {Vector3(0.03, 0.02, 0.1), Vector3(0.05, 0.1, 0.127), Vector3(0.612, 0.15, 0.13),
                           Vector3(1.184, 0.12, 0.14), Vector3(1.181, 0.163941, 0.1), Vector3(1.181, 0.2, 0.0116)});
  for (const int i : {0, 1, 2, 3}) expect_exact_with_points_far_out(three, {i}, ArmKind::three_parallel);
  expect_exact_with_points_far_out(three, {1, 2, 3}, ArmKind::three_parallel);
  const Vector3 wrist(0.302, 0.01, 0.63);
  const SixAxes two = arm_of({z, y, y, x, y, x}, {Vector3(0.03, 0.02, 0.1), Vector3(0.05, 0.1, 0.29),
                                                  Vector3(0.06, 0.15, 0.56), wrist, wrist, wrist});
  for (const int i : {0, 1, 2}) expect_exact_with_points_far_out(two, {i}, ArmKind::second_parallel_to_third);
  expect_exact_with_points_far_out(two, {0, 1, 2}, ArmKind::second_parallel_to_third);
}

}  // namespace
}  // namespace vernier::closed_form_arm_test
