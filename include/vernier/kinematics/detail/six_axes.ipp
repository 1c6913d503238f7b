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
VERNIER_API Eigen::Matrix<double, 3, 6> near_points(const SixAxes& arm) noexcept {
  Eigen::Matrix<double, 3, 6> out = arm.point;
  for (int round = 0; round < 20; ++round)
    for (int i = 0; i < 6; ++i) {
      Vector3 to = i == 0 ? out.col(1) : i == 5 ? out.col(4) : Vector3(0.5 * (out.col(i - 1) + out.col(i + 1)));
      out.col(i) += arm.direction.col(i) * arm.direction.col(i).dot(to - out.col(i));
    }
  return out;
}

VERNIER_IMPL double arm_length(const SixAxes& arm) noexcept {
  double out = (arm.tool.translation() - arm.point.col(5)).norm();
  for (int i = 0; i < 5; ++i) out += (arm.point.col(i + 1) - arm.point.col(i)).norm();
  return out;
}

VERNIER_IMPL double reach_excess(const SixAxes& arm, const Isometry3& target) noexcept {
  // The point of axis 6 is fixed in the tool, that of axis 1 in the base; links between them have constant lengths.
  const Eigen::Matrix<double, 3, 6> points = near_points(arm);
  const Vector3 end = target * (arm.tool.inverse() * Vector3(points.col(5)));
  double out = (end - points.col(0)).norm();
  for (int i = 0; i < 5; ++i) out -= (points.col(i + 1) - points.col(i)).norm();
  return out;
}

}  // namespace vernier::detail
