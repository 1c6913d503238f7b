// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured distances of the tool point from a fixed point, as by a draw-wire encoder or a ball-bar; and touches of a
/// ball, whose centre is such a point.

#include <utility>

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Distances from the origin of the sensor's frame, whose place need not be known. Rotations have no effect.
class DistanceSensor {
 public:
  /// @param lengths n distances [m]
  /// @param sigma   standard deviation of one [m]
  explicit DistanceSensor(VectorX lengths, double sigma = SensorModel{}.distance_sigma)
      : lengths_(std::move(lengths)), sigma_(sigma) {}

  /// Its name in messages and reports.
  const char* kind() const { return "distances"; }
  /// Number of measurements.
  Index size() const { return lengths_.size(); }
  /// Measured values of each.
  Index values() const { return 1; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return {sigma_, 1}; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {true, true, true, false, false, false}; }
  /// When the measurements cannot be of this arm.
  Plausibility plausibility() const {
    return {0.05, "no fixed point is consistent with these distances, the best one is off by",
            "wrong units, columns or rows?"};
  }
  /// With the accuracy that a user states for its kind.
  DistanceSensor with(const SensorModel& sensors) const { return DistanceSensor(lengths_, sensors.distance_sigma); }

  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// By linear least squares on squared distances; without rotation.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  VectorX lengths_;
  double sigma_;
};

/// Touches of a ball whose place need not be known: distances from its centre.
class BallSensor {
 public:
  /// @param radii n radii of ball and probe together [m]
  /// @param sigma standard deviation of a touch [m]
  explicit BallSensor(VectorX radii, double sigma = SensorModel{}.contact_sigma) : radii_(std::move(radii), sigma) {}

  /// Its name in messages and reports.
  const char* kind() const { return "ball"; }
  /// Number of measurements.
  Index size() const { return radii_.size(); }
  /// Measured values of each.
  Index values() const { return 1; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return radii_.sigma(); }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return radii_.unknown_frame(); }
  /// When the measurements cannot be of this arm.
  VERNIER_API Plausibility plausibility() const;
  /// With the accuracy that a user states for its kind.
  VERNIER_API BallSensor with(const SensorModel& sensors) const;
  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// The base frame that fits poses in the arm's own base frame.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  explicit BallSensor(DistanceSensor radii) : radii_(std::move(radii)) {}
  DistanceSensor radii_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/distance_sensor.ipp"
#endif
