// SPDX-License-Identifier: BSD-3-Clause
// A sensor whose `plausibility` is not const, between two configurations known at run time.
// expect: Sensor: `plausibility()` must be const and return vernier::Plausibility
#include <vernier/measurements/measurements.hpp>

namespace vn = vernier;

#ifdef MISTAKE
#define CONST
#else
#define CONST const
#endif

struct DialGauge {
  const char* kind() const;
  vn::Index size() const;
  vn::Index values() const;
  vn::SensorSigma sigma() const;
  void sense(vn::Index i, const vn::Isometry3& pose, vn::SensedRows& rows) const;
  std::array<bool, 6> unknown_frame() const;
  vn::Isometry3 base_from(std::span<const vn::Isometry3> poses) const;
  vn::Plausibility plausibility() CONST;
};

void add(vn::Measurements<6>& measured, const vn::MatrixX& from, const vn::MatrixX& to, const DialGauge& gauge) {
  measured.add_between(from, to, gauge);
}
