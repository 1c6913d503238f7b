// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/rigid_motions.hpp"
#include "vernier/measurements/plane_sensor.hpp"
#include "vernier/measurements/touch.hpp"

namespace vernier {

VERNIER_IMPL Plausibility PlaneSensor::plausibility() const { return detail::plausible_touches; }

VERNIER_IMPL void PlaneSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  detail::one_length(translation(pose).z() - heights_(i), Vector3(0, 0, 1), rows);
}

VERNIER_IMPL Isometry3 PlaneSensor::base_from(std::span<const Isometry3> poses) const {
  const PointRows points = detail::positions_of(poses);
  const Matrix3 turn = detail::rotation_to_z(detail::fitted_normal(points, heights_));
  const Vector3 middle = turn * centroid(points);
  return rigid_motion(turn, Vector3(0, 0, heights_.mean() - middle.z()));
}

}  // namespace vernier
