// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Touches of sockets along a bar, at known distances from the first one.

#include <utility>

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Touches of points on the z axis of the sensor's frame, whose place need not be known. Rotations about the bar have
/// no effect.
class BarSensor {
 public:
  /// @param offsets n distances of the touched socket from the first one [m], not all equal
  /// @param sigma   standard deviation of a touch, per component [m]
  explicit BarSensor(VectorX offsets, double sigma = SensorModel{}.contact_sigma)
      : offsets_(std::move(offsets)), sigma_(sigma) {}

  /// Its name in messages and reports.
  const char* kind() const { return "bar"; }
  /// Number of measurements.
  Index size() const { return offsets_.size(); }
  /// Measured values of each.
  Index values() const { return 3; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return {sigma_, 1}; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {true, true, true, true, true, false}; }
  /// With the accuracy that a user states for its kind.
  BarSensor with(const SensorModel& sensors) const { return BarSensor(offsets_, sensors.contact_sigma); }

  /// When the measurements cannot be of this arm.
  VERNIER_API Plausibility plausibility() const;
  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// The base frame that fits poses in the arm's own base frame.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  VectorX offsets_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/bar_sensor.ipp"
#endif
