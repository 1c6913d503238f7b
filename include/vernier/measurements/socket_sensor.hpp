// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Touches of a socket: a point that the tool point visits again and again.

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Touches of the origin of the sensor's frame, whose place need not be known. Rotations have no effect.
class SocketSensor {
 public:
  /// @param touches their number
  /// @param sigma   standard deviation of a touch, per component [m]
  explicit SocketSensor(Index touches, double sigma = SensorModel{}.contact_sigma) : touches_(touches), sigma_(sigma) {}

  /// Its name in messages and reports.
  const char* kind() const { return "socket"; }
  /// Number of measurements.
  Index size() const { return touches_; }
  /// Measured values of each.
  Index values() const { return 3; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return {sigma_, 1}; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {true, true, true, false, false, false}; }
  /// With the accuracy that a user states for its kind.
  SocketSensor with(const SensorModel& sensors) const { return SocketSensor(touches_, sensors.contact_sigma); }

  /// When the measurements cannot be of this arm.
  VERNIER_API Plausibility plausibility() const;
  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// The base frame that fits poses in the arm's own base frame.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  Index touches_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/socket_sensor.ipp"
#endif
