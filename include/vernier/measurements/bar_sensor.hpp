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

  const char* kind() const { return "bar"; }
  Index size() const { return offsets_.size(); }
  Index values() const { return 3; }
  SensorSigma sigma() const { return {sigma_, 1}; }
  std::array<bool, 6> unknown_frame() const { return {true, true, true, true, true, false}; }
  BarSensor with(const SensorModel& sensors) const { return BarSensor(offsets_, sensors.contact_sigma); }

  VERNIER_API Plausibility plausibility() const;
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  VectorX offsets_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/bar_sensor.ipp"
#endif
