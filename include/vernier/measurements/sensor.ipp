// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/rigid_motions.hpp"
#include "vernier/measurements/sensor.hpp"

namespace vernier::detail {

VERNIER_IMPL PointRows positions_of(std::span<const Isometry3> poses) {
  PointRows out(static_cast<Index>(poses.size()), 3);
  for (Index i = 0; i < out.rows(); ++i) set_point(out, i, translation(poses[static_cast<std::size_t>(i)]));
  return out;
}

VERNIER_IMPL void one_length(double residual, const Vector3& along, SensedRows& rows) {
  rows.residual.setZero();
  rows.motion.setZero();
  rows.residual(0) = residual;
  for (Index k = 0; k < 3; ++k) rows.motion(0, k) = along(k);
}

VERNIER_IMPL void three_lengths(const Vector3& residual, SensedRows& rows) {
  rows.residual.setZero();
  rows.motion.setZero();
  for (Index k = 0; k < 3; ++k) {
    rows.residual(k) = residual(k);
    rows.motion(k, k) = 1;
  }
}

}  // namespace vernier::detail
