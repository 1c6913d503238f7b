// SPDX-License-Identifier: BSD-3-Clause
// A sensor that does not say how its measurements depend on the pose.
// expect: Sensor: `sense(i, pose, rows)` must be const and take vernier::Index, vernier::Isometry3
#include <vernier/measurements/measurements.hpp>

namespace vn = vernier;

struct DialGauge {
  const char* kind() const;
  vn::Index size() const;
  vn::Index values() const;
  vn::SensorSigma sigma() const;
#ifndef MISTAKE
  void sense(vn::Index i, const vn::Isometry3& pose, vn::SensedRows& rows) const;
#endif
  std::array<bool, 6> unknown_frame() const;
  vn::Isometry3 base_from(std::span<const vn::Isometry3> poses) const;
  vn::Plausibility plausibility() const;
};

void add(vn::Measurements<6>& measured, const vn::JointRows<6>& joints, const DialGauge& gauge) {
  measured.add(joints, gauge);
}
