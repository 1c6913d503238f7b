// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/so3.hpp"
#include "vernier/identification/detail/twists.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 shifted(const Isometry3& pose, const Vector6& by) {
  const Vector3 shift = VERNIER_LATER(by).template head<3>(), turn = VERNIER_LATER(by).template tail<3>();
  return rigid_motion(exp_so3(turn) * rotation(pose), translation(pose) + shift);
}

VERNIER_IMPL Matrix6 effect_of_twist(const Vector3& lever) {
  Matrix6 out = Matrix6::Identity();
  const Matrix3 cross = skew(lever);
  for (Index c = 0; c < 3; ++c)
    for (Index r = 0; r < 3; ++r) out(r, c + 3) = -cross(r, c);
  return out;
}

VERNIER_IMPL void turn_columns(const Matrix3& rotation, Rows6& columns) {
  for (Index k = 0; k < 2 * columns.cols(); ++k) {
    double* part = columns.data() + 3 * k;
    const Vector3 turned = rotation * Vector3(part[0], part[1], part[2]);
    std::copy_n(turned.data(), 3, part);
  }
}

}  // namespace vernier::detail
