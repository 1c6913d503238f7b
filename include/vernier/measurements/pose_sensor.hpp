// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measured poses of the tool: position and orientation, as by a laser tracker with a six-dimensional probe.

#include <utility>
#include <vector>

#include "vernier/measurements/sensor.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier {

/// Poses in the frame of the measuring device.
class PoseSensor {
 public:
  /// @param positions    n x 3 [m]
  /// @param orientations n rotation matrices; none: positions alone are used
  /// @param sigma        standard deviations per component [m, rad]
  /// @param covariances  of position and rotation vector in the sensor's frame (rotations from the left) [m, rad], one
  ///                     a measurement; none: those of `sigma`
  PoseSensor(PointRows positions, std::vector<Matrix3> orientations,
             SensorSigma sigma = {SensorModel{}.position_sigma, SensorModel{}.orientation_sigma},
             std::vector<Matrix6> covariances = {})
      : positions_(std::move(positions)),
        orientations_(std::move(orientations)),
        sigma_(sigma),
        covariances_(std::move(covariances)) {}

  /// Its name in messages and reports.
  const char* kind() const { return "poses"; }
  /// Number of measurements.
  Index size() const { return positions_.rows(); }
  /// Measured values of each.
  Index values() const { return orientations_.empty() ? 3 : 6; }
  /// Standard deviations of the values.
  SensorSigma sigma() const { return sigma_; }
  /// Measured positions [m], n x 3.
  const PointRows& positions() const { return positions_; }
  /// Measured orientations; none if positions alone are used.
  const std::vector<Matrix3>& orientations() const { return orientations_; }
  /// Covariances of position and orientation [m, rad], one a measurement; none: `sigma()` holds for all.
  const std::vector<Matrix6>& covariances() const { return covariances_; }
  /// What the measurements determine of the base frame.
  std::array<bool, 6> unknown_frame() const { return {true, true, true, true, true, true}; }
  /// When the measurements cannot be of this arm.
  Plausibility plausibility() const { return {0.05, "the arm is off by", "wrong robot, units or columns?"}; }
  /// Without orientations where `use_orientations` is off.
  VERNIER_API PoseSensor with(const SensorModel& sensors) const {
    return {positions_,
            sensors.use_orientations ? orientations_ : std::vector<Matrix3>(),
            {sensors.position_sigma, sensors.orientation_sigma},
            covariances_};
  }

  /// Measurement i at a pose of the tool point.
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  /// By positions alone.
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  PointRows positions_;
  std::vector<Matrix3> orientations_;
  SensorSigma sigma_;
  std::vector<Matrix6> covariances_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/pose_sensor.ipp"
#endif
