// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/urdf/detail/roll_pitch_yaw.hpp"

#include <cmath>

namespace vernier::detail {

VERNIER_IMPL Matrix3 from_roll_pitch_yaw(const Vector3& rpy) {
  const double cr = std::cos(rpy.x()), sr = std::sin(rpy.x()), cp = std::cos(rpy.y()), sp = std::sin(rpy.y()),
               cy = std::cos(rpy.z()), sy = std::sin(rpy.z());
  Matrix3 out;
  out << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,     //
      -sp, cp * sr, cp * cr;
  return out;
}

VERNIER_IMPL Vector3 roll_pitch_yaw(const Matrix3& rotation) {
  const double cosine = std::hypot(rotation(0, 0), rotation(1, 0));
  const double yaw = cosine < 1e-12 ? 0 : std::atan2(rotation(1, 0), rotation(0, 0));
  // Roll is read behind the rounded yaw, so next to a pitch of pi/2 the error of one is taken back by the other.
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double roll = std::atan2(s * rotation(0, 2) - c * rotation(1, 2), c * rotation(1, 1) - s * rotation(0, 1));
  return {roll, std::atan2(-rotation(2, 0), cosine), yaw};
}

}  // namespace vernier::detail
