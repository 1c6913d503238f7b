// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/register_points.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/measurements/position_sensor.hpp"

namespace vernier {

VERNIER_IMPL void PositionSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  detail::three_lengths(translation(pose) - point(positions_, i), rows);
}

VERNIER_IMPL Isometry3 PositionSensor::base_from(std::span<const Isometry3> poses) const {
  return register_points(detail::positions_of(poses), positions_);
}

}  // namespace vernier
