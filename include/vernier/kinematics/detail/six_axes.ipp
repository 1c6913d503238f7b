// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/six_axes.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 pose_of(const SixAxes& arm, const JointVector<6>& q) noexcept {
  Matrix3 turned = rotation(arm.tool);
  Vector3 position = translation(arm.tool);
  for (int i = 5; i >= 0; --i) {
    const Matrix3 turn = exp_so3(Vector3(q(i) * arm.direction_of(i))), before = turned;
    const Vector3 point = arm.point_of(i);
    position = point + rotated(turn, position - point);
    turned = times3(turn, before);
  }
  return rigid_motion(turned, position);
}

/// Moves points along the axes, each as near to its neighbours as a few rounds bring it. Any points give a bound of the
/// arm's length; these give a tight one.
VERNIER_LOCAL void move_together(const ArmAxes& arm, Vector3* points) noexcept {
  const int last = arm.joints - 1;
  for (int round = 0; round < 20; ++round)
    for (int i = 0; i <= last; ++i) {
      Vector3 to = points[i == 0 ? 1 : i - 1];
      if (i > 0 && i < last) {
        const Vector3 sum = to + points[i + 1];
        to = 0.5 * sum;
      }
      const Vector3 off = to - points[i];
      points[i] += arm.direction[i].dot(off) * arm.direction[i];
    }
}

/// Length of the way from point to point.
VERNIER_LOCAL inline double length_through(const Vector3* points, int n) noexcept {
  double out = 0;
  for (int i = 0; i + 1 < n; ++i) out += (points[i + 1] - points[i]).norm();
  return out;
}

VERNIER_IMPL double arm_length(const ArmAxes& arm) noexcept {
  return length_through(arm.point, arm.joints) + (translation(arm.tool) - arm.point[arm.joints - 1]).norm();
}

VERNIER_IMPL double arm_length(const SixAxes& arm) noexcept {
  Vector3 points[7];
  for (int i = 0; i < 6; ++i) points[i] = arm.point_of(i);
  points[6] = translation(arm.tool);
  return length_through(points, 7);
}

VERNIER_IMPL double reach_excess(const ArmAxes& arm, const Isometry3& target) noexcept {
  // The point of the last axis is fixed in the tool, that of axis 1 in the base; links between have constant lengths.
  Vector3 points[7];
  for (int i = 0; i < arm.joints; ++i) points[i] = arm.point[i];
  move_together(arm, points);
  const Vector3 end = transformed(target, transformed(inverse_of(arm.tool), points[arm.joints - 1]));
  return (end - points[0]).norm() - length_through(points, arm.joints);
}

}  // namespace vernier::detail
