// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/error_model/error_model.hpp"

namespace vernier::detail {

VERNIER_IMPL void blend_jacobians(double gate, const double* slope, const Isometry3& inside,
                                  const double* inside_jacobian, const Isometry3& outside, Index joints,
                                  double* jacobian) noexcept {
  // R = Exp(gate * phi) R_far with Exp(phi) = R_near R_far'
  const Vector3 apart = translation(inside) - translation(outside);
  const Matrix3 back = VERNIER_LATER(rotation(outside)).transpose(), between = rotation(inside) * back;
  const Vector3 phi = log_so3(between), part = gate * phi;
  const Matrix3 inverse = left_jacobian_inverse_so3(phi), left = left_jacobian_so3(part), turned = exp_so3(part);
  for (Index k = 0; k < joints; ++k) {
    const double* inside_column = inside_jacobian + 6 * k;
    double* column = jacobian + 6 * k;
    const Vector3 angular(column[3], column[4], column[5]),
        inside_angular(inside_column[3], inside_column[4], inside_column[5]);
    const Vector3 carried = between * angular, phi_rate = inverse * Vector3(inside_angular - carried);
    Vector3 part_rate = gate * phi_rate;
    part_rate += slope[k] * phi;
    Vector3 blended = left * part_rate;
    blended += turned * angular;
    for (Index r = 0; r < 3; ++r) {
      column[r] += gate * (inside_column[r] - column[r]) + apart(r) * slope[k];
      column[3 + r] = blended(r);
    }
  }
}

}  // namespace vernier::detail
