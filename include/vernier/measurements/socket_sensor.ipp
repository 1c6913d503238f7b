// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/rigid_motions.hpp"
#include "vernier/measurements/socket_sensor.hpp"
#include "vernier/measurements/touch.hpp"

namespace vernier {

VERNIER_IMPL Plausibility SocketSensor::plausibility() const { return detail::plausible_touches; }

VERNIER_IMPL void SocketSensor::sense(Index, const Isometry3& pose, SensedRows& rows) const {
  detail::three_lengths(translation(pose), rows);
}

VERNIER_IMPL Isometry3 SocketSensor::base_from(std::span<const Isometry3> poses) const {
  const Vector3 shift = -centroid(detail::positions_of(poses));
  return rigid_motion(Matrix3::Identity(), shift);
}

}  // namespace vernier
