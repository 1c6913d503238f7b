// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured positions of the tool point, as by a laser tracker.

#include <utility>
#include <vector>

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Positions in the frame of the measuring device.
class PositionSensor {
 public:
  /// @param positions n x 3 [m]
  /// @param sigma     standard deviation per component [m]
  /// @param covariances of the positions, in the first three rows and columns [m], one a measurement; none: `sigma`
  explicit PositionSensor(PointRows positions, double sigma = SensorModel{}.position_sigma,
                          std::vector<Matrix6> covariances = {})
      : positions_(std::move(positions)), sigma_(sigma), covariances_(std::move(covariances)) {}

  /// Its name in messages and reports.
  const char* kind() const { return "positions"; }
  /// Number of measurements.
  Index size() const { return positions_.rows(); }
  /// Measured values of each.
  Index values() const { return 3; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return {sigma_, 1}; }
  /// Measured positions [m], n x 3.
  const PointRows& positions() const { return positions_; }
  /// Covariances of position and orientation [m, rad], one a measurement; none: `sigma()` holds for all.
  const std::vector<Matrix6>& covariances() const { return covariances_; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {true, true, true, true, true, true}; }
  /// When the measurements cannot be of this arm.
  Plausibility plausibility() const { return {0.05, "the arm is off by", "wrong robot, units or columns?"}; }
  /// With the accuracy that a user states for its kind.
  PositionSensor with(const SensorModel& sensors) const {
    return PositionSensor(positions_, sensors.position_sigma, covariances_);
  }

  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// The base frame that fits poses in the arm's own base frame.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  PointRows positions_;
  double sigma_;
  std::vector<Matrix6> covariances_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/position_sensor.ipp"
#endif
