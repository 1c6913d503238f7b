#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/six_axes.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 pose_of(const SixAxes& arm, const JointVector<6>& q) noexcept {
  Isometry3 out = arm.tool;
  for (int i = 5; i >= 0; --i) {
    const Matrix3 turn = exp_so3(Vector3(arm.direction.col(i) * q(i)));
    const Vector3 point = arm.point.col(i);
    out.translation() = (point + turn * (out.translation() - point)).eval();
    out.linear() = (turn * out.linear()).eval();
  }
  return out;
}

/// Points of the axes, each as near to its neighbours as a few rounds of moving along the axis bring it. Any points
/// give a bound; these give a tight one.
VERNIER_API ArmAxes::Columns near_points(const ArmAxes& arm) noexcept {
  ArmAxes::Columns out = arm.point;
  const Index last = out.cols() - 1;
  for (int round = 0; round < 20; ++round)
    for (Index i = 0; i <= last; ++i) {
      const Vector3 to = i == 0      ? Vector3(out.col(1))
                         : i == last ? Vector3(out.col(last - 1))
                                     : Vector3(0.5 * (out.col(i - 1) + out.col(i + 1)));
      out.col(i) += arm.direction.col(i) * arm.direction.col(i).dot(to - out.col(i));
    }
  return out;
}

VERNIER_IMPL double arm_length(const ArmAxes& arm) noexcept {
  const Index last = arm.point.cols() - 1;
  double out = (arm.tool.translation() - arm.point.col(last)).norm();
  for (Index i = 0; i < last; ++i) out += (arm.point.col(i + 1) - arm.point.col(i)).norm();
  return out;
}

VERNIER_IMPL double reach_excess(const ArmAxes& arm, const Isometry3& target) noexcept {
  // The point of the last axis is fixed in the tool, that of axis 1 in the base; links between have constant lengths.
  const ArmAxes::Columns points = near_points(arm);
  const Index last = points.cols() - 1;
  const Vector3 end = target * (arm.tool.inverse() * Vector3(points.col(last)));
  double out = (end - points.col(0)).norm();
  for (Index i = 0; i < last; ++i) out -= (points.col(i + 1) - points.col(i)).norm();
  return out;
}

}  // namespace vernier::detail
