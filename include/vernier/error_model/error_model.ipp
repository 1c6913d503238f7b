#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/error_model/error_model.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 blend_poses(double gate, const Isometry3& near, const Isometry3& far) noexcept {
  Isometry3 out = far;
  out.translation() += gate * (near.translation() - far.translation());
  out.linear() = exp_so3(Vector3(gate * log_so3(near.linear() * far.linear().transpose()))) * far.linear();
  return out;
}

VERNIER_IMPL void blend_jacobians(double gate, const double* slope, const Isometry3& near, const double* near_jacobian,
                                  const Isometry3& far, Index joints, double* jacobian) noexcept {
  // R = Exp(gate * phi) R_far with Exp(phi) = R_near R_far'
  const Vector3 apart = near.translation() - far.translation();
  const Matrix3 between = near.linear() * far.linear().transpose();
  const Vector3 phi = log_so3(between), part = gate * phi;
  const Matrix3 inverse = left_jacobian_inverse_so3(phi), left = left_jacobian_so3(part), turned = exp_so3(part);
  for (Index k = 0; k < joints; ++k) {
    const Eigen::Map<const Vector3> near_linear(near_jacobian + 6 * k), near_angular(near_jacobian + 6 * k + 3);
    Eigen::Map<Vector3> linear(jacobian + 6 * k), angular(jacobian + 6 * k + 3);
    linear += gate * (near_linear - linear) + apart * slope[k];
    const Vector3 phi_rate = inverse * (near_angular - between * angular);
    angular = left * (gate * phi_rate + phi * slope[k]) + turned * angular;
  }
}

}  // namespace vernier::detail
