// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/trilaterate.hpp"
#include "vernier/measurements/distance_sensor.hpp"
#include "vernier/measurements/touch.hpp"

namespace vernier {

VERNIER_IMPL void DistanceSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  const Vector3 point = translation(pose);
  detail::one_length(point.norm() - lengths_(i), VERNIER_LATER(point).normalized(), rows);
}

VERNIER_IMPL Isometry3 DistanceSensor::base_from(std::span<const Isometry3> poses) const {
  const Vector3 shift = -trilaterate(detail::positions_of(poses), lengths_);
  return rigid_motion(Matrix3::Identity(), shift);
}

VERNIER_IMPL Plausibility BallSensor::plausibility() const { return detail::plausible_touches; }

VERNIER_IMPL BallSensor BallSensor::with(const SensorModel& sensors) const {
  return BallSensor(radii_.with({.distance_sigma = sensors.contact_sigma}));
}

VERNIER_IMPL void BallSensor::sense(Index i, const Isometry3& pose, SensedRows& rows) const {
  radii_.sense(i, pose, rows);
}

VERNIER_IMPL Isometry3 BallSensor::base_from(std::span<const Isometry3> poses) const { return radii_.base_from(poses); }

}  // namespace vernier
