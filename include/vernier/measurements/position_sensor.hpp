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
  explicit PositionSensor(PointRows positions, double sigma = SensorModel{}.position_sigma)
      : positions_(std::move(positions)), sigma_(sigma) {}

  const char* kind() const { return "positions"; }
  Index size() const { return positions_.rows(); }
  Index values() const { return 3; }
  SensorSigma sigma() const { return {sigma_, 1}; }
  const PointRows& positions() const { return positions_; }
  std::array<bool, 6> unknown_frame() const { return {true, true, true, true, true, true}; }
  Plausibility plausibility() const { return {0.05, "the arm is off by", "wrong robot, units or columns?"}; }
  PositionSensor with(const SensorModel& sensors) const { return PositionSensor(positions_, sensors.position_sigma); }

  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  PointRows positions_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/position_sensor.ipp"
#endif
