// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/rigid_motions.hpp"
#include "vernier/measurements/bar_sensor.hpp"
#include "vernier/measurements/touch.hpp"

namespace vernier {

VERNIER_IMPL Plausibility BarSensor::plausibility() const { return detail::plausible_touches; }

VERNIER_IMPL void BarSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  detail::three_lengths(translation(pose) - Vector3(0, 0, offsets_(i)), rows);
}

VERNIER_IMPL Isometry3 BarSensor::base_from(std::span<const Isometry3> poses) const {
  const PointRows points = detail::positions_of(poses);
  const Matrix3 turn = detail::rotation_to_z(detail::rise_of(points, offsets_).normalized());
  const Vector3 middle = turn * centroid(points);
  return rigid_motion(turn, Vector3(-middle.x(), -middle.y(), offsets_.mean() - middle.z()));
}

}  // namespace vernier
