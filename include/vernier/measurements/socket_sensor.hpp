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

  const char* kind() const { return "socket"; }
  Index size() const { return touches_; }
  Index values() const { return 3; }
  SensorSigma sigma() const { return {sigma_, 1}; }
  std::array<bool, 6> unknown_frame() const { return {true, true, true, false, false, false}; }
  SocketSensor with(const SensorModel& sensors) const { return SocketSensor(touches_, sensors.contact_sigma); }

  VERNIER_API Plausibility plausibility() const;
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  Index touches_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/socket_sensor.ipp"
#endif
