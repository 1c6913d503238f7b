// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/register_points.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/measurements/pose_sensor.hpp"

namespace vernier {

VERNIER_IMPL void PoseSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  detail::three_lengths(translation(pose) - point(positions_, i), rows);
  if (orientations_.empty()) return;
  const Vector3 turn = rotation_difference(rotation(pose), orientations_[static_cast<std::size_t>(i)]);
  const Matrix3 rate = left_jacobian_inverse_so3(turn);
  for (Index c = 0; c < 3; ++c) {
    rows.residual(3 + c) = turn(c);
    for (Index r = 0; r < 3; ++r) rows.motion(3 + r, 3 + c) = rate(r, c);
  }
}

VERNIER_IMPL Isometry3 PoseSensor::base_from(std::span<const Isometry3> poses) const {
  return register_points(detail::positions_of(poses), positions_);
}

}  // namespace vernier
