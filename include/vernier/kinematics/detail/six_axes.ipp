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

}  // namespace vernier::detail
