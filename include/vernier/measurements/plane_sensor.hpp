// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Touches of a plane, or of parallel faces at known heights.

#include <utility>

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Heights of the tool point over the plane z = 0 of the sensor's frame, whose place need not be known. Motions in the
/// plane have no effect.
class PlaneSensor {
 public:
  /// @param heights n heights of the touched face over the first one [m]
  /// @param sigma   standard deviation of a touch [m]
  explicit PlaneSensor(VectorX heights, double sigma = SensorModel{}.contact_sigma)
      : heights_(std::move(heights)), sigma_(sigma) {}

  /// Its name in messages and reports.
  const char* kind() const { return "plane"; }
  /// Number of measurements.
  Index size() const { return heights_.size(); }
  /// Measured values of each.
  Index values() const { return 1; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return {sigma_, 1}; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {false, false, true, true, true, false}; }
  /// With the accuracy that a user states for its kind.
  PlaneSensor with(const SensorModel& sensors) const { return PlaneSensor(heights_, sensors.contact_sigma); }

  /// When the measurements cannot be of this arm.
  VERNIER_API Plausibility plausibility() const;
  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// The base frame that fits poses in the arm's own base frame.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  VectorX heights_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/plane_sensor.ipp"
#endif
