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

  const char* kind() const { return "plane"; }
  Index size() const { return heights_.size(); }
  Index values() const { return 1; }
  SensorSigma sigma() const { return {sigma_, 1}; }
  std::array<bool, 6> unknown_frame() const { return {false, false, true, true, true, false}; }
  PlaneSensor with(const SensorModel& sensors) const { return PlaneSensor(heights_, sensors.contact_sigma); }

  VERNIER_API Plausibility plausibility() const;
  VERNIER_API void sense(Index i, const Isometry3& pose, SensedRows& rows) const;
  VERNIER_API Isometry3 base_from(std::span<const Isometry3> poses) const;

 private:
  VectorX heights_;
  double sigma_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/plane_sensor.ipp"
#endif
