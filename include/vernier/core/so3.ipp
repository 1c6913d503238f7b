// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/so3.hpp"

#include <cmath>

namespace vernier {

namespace detail {

VERNIER_IMPL Matrix3 double_exp_so3(const Vector3& r) { return generic_exp_so3(r); }

VERNIER_IMPL Vector3 double_log_so3(const Matrix3& m) { return generic_log_so3(m); }

}  // namespace detail

VERNIER_IMPL Matrix3 left_jacobian_so3(const Vector3& r) {
  const double angle2 = r.squaredNorm();
  double b, c;  // (1 - cos t)/t^2 and (t - sin t)/t^3
  if (angle2 < 1e-4) {
    b = 0.5 - angle2 / 24 + angle2 * angle2 / 720;
    c = 1.0 / 6 - angle2 / 120 + angle2 * angle2 / 5040;
  } else {
    const double angle = std::sqrt(angle2), half_sine = std::sin(angle / 2);
    b = 2 * half_sine * half_sine / angle2;
    c = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const auto k = VERNIER_LATER(skew(r));
  return Matrix3::Identity() + b * k + c * (k * k);
}

VERNIER_IMPL Matrix3 left_jacobian_inverse_so3(const Vector3& r) {
  const double angle2 = r.squaredNorm();
  double c;
  if (angle2 < 1e-4) {
    c = 1.0 / 12 + angle2 / 720 + angle2 * angle2 / 30240;
  } else {
    const double half = std::sqrt(angle2) / 2;
    c = (1 - half * std::cos(half) / std::sin(half)) / angle2;
  }
  const auto k = VERNIER_LATER(skew(r));
  return Matrix3::Identity() - 0.5 * k + c * (k * k);
}

VERNIER_IMPL Vector3 rotation_difference(const Matrix3& to, const Matrix3& from) {
  const Matrix3 back = VERNIER_LATER(from).transpose();
  return detail::double_log_so3(VERNIER_LATER(to) * back);
}

VERNIER_IMPL Vector6 pose_difference(const Isometry3& to, const Isometry3& from) {
  const Vector3 shift = VERNIER_LATER(translation(to)) - translation(from);
  const Vector3 turn = rotation_difference(rotation(to), rotation(from));
  Vector6 out;
  for (Index c = 0; c < 3; ++c) {
    out(c) = shift(c);
    out(c + 3) = turn(c);
  }
  return out;
}

VERNIER_IMPL Isometry3 interpolated(const Isometry3& from, const Isometry3& to, double fraction) noexcept {
  const auto start = VERNIER_LATER(translation(from)), apart = VERNIER_LATER(Vector3(translation(to) - start));
  const auto orientation = VERNIER_LATER(rotation(from));
  const Vector3 turn = fraction * VERNIER_LATER(rotation_difference(rotation(to), orientation));
  return rigid_motion(exp_so3(turn) * orientation, start + fraction * apart);
}

}  // namespace vernier
