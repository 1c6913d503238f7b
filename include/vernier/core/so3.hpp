// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rotations: exponential and logarithm, exact at the identity and near pi, in any scalar (dual numbers included).

#include <cmath>
#include <type_traits>

#include "vernier/core/rigid_motions.hpp"

namespace vernier {

namespace detail {

template <class S>
Eigen::Matrix<S, 3, 3> generic_exp_so3(const Eigen::Matrix<S, 3, 1>& r);
template <class S>
Eigen::Matrix<S, 3, 1> generic_log_so3(const Eigen::Matrix<S, 3, 3>& m);
VERNIER_API Matrix3 double_exp_so3(const Vector3& r);
VERNIER_API Vector3 double_log_so3(const Matrix3& m);

}  // namespace detail

/// The matrix of the cross product, `skew(a) b = a x b`.
template <class Derived>
Eigen::Matrix<typename Derived::Scalar, 3, 3> skew(const Eigen::MatrixBase<Derived>& a) {
  using S = typename Derived::Scalar;
  Eigen::Matrix<S, 3, 3> m;
  m << S(0), -a.z(), a.y(), a.z(), S(0), -a.x(), -a.y(), a.x(), S(0);
  return m;
}

/// Rotation matrix of a rotation vector [rad]; value and first derivative are exact at zero.
/// @cite Sola 2018
template <class Derived>
Eigen::Matrix<typename Derived::Scalar, 3, 3> exp_so3(const Eigen::MatrixBase<Derived>& r) {
  using S = typename Derived::Scalar;
  if constexpr (std::is_same_v<S, double>) {
    return detail::double_exp_so3(r.derived());
  } else {
    return detail::generic_exp_so3<S>(r.derived());
  }
}

/// Rotation vector [rad] of a rotation matrix, angle in [0, pi]; exact at the identity (value and derivative) and near
/// pi. Through the unit quaternion with the largest component, so that no step loses digits.
/// @cite Sola 2018
template <class Derived>
Eigen::Matrix<typename Derived::Scalar, 3, 1> log_so3(const Eigen::MatrixBase<Derived>& rotation) {
  using S = typename Derived::Scalar;
  if constexpr (std::is_same_v<S, double>) {
    return detail::double_log_so3(rotation.derived());
  } else {
    return detail::generic_log_so3<S>(rotation.derived());
  }
}

/// Left Jacobian of SO(3): `exp(r + dr) ~ exp(Jl(r) dr) exp(r)`, so it maps the rate of a rotation vector to
/// the angular velocity in the outer frame.
/// @cite Sola 2018
VERNIER_API Matrix3 left_jacobian_so3(const Vector3& r);

/// Inverse of `left_jacobian_so3`; finite for angles below 2 pi.
/// @cite Sola 2018
VERNIER_API Matrix3 left_jacobian_inverse_so3(const Vector3& r);

/// The rotation vector [rad] that takes `from` to `to`, in the base frame: `Log(R_to R_from')`.
VERNIER_API Vector3 rotation_difference(const Matrix3& to, const Matrix3& from);

/// The twist that takes `from` to `to`, in the base frame: `[p_to - p_from; Log(R_to R_from')]`, m and rad.
VERNIER_API Vector6 pose_difference(const Isometry3& to, const Isometry3& from);

/// A pose between two: `from` at a fraction of 0, `to` at 1; the position is interpolated linearly, the orientation
/// about the fixed axis from one to the other.
/// @cite Sola 2018
VERNIER_API Isometry3 interpolated(const Isometry3& from, const Isometry3& to, double fraction) noexcept;

namespace detail {

template <class S>
Eigen::Matrix<S, 3, 3> generic_exp_so3(const Eigen::Matrix<S, 3, 1>& r) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const S angle2 = r.squaredNorm();
  S a, b;  // sin(t)/t and (1 - cos t)/t^2
  if (angle2 < S(1e-8)) {
    a = S(1) - angle2 / S(6) + angle2 * angle2 / S(120);
    b = S(0.5) - angle2 / S(24) + angle2 * angle2 / S(720);
  } else {
    const S angle = sqrt(angle2);
    const S half_sine = sin(angle / S(2));
    a = sin(angle) / angle;
    b = S(2) * half_sine * half_sine / angle2;
  }
  const Eigen::Matrix<S, 3, 3> k = skew(r);
  Eigen::Matrix<S, 3, 3> rotation = a * k;
  rotation.noalias() += b * (k * k);
  rotation.diagonal().array() += S(1);
  return rotation;
}

template <class S>
Eigen::Matrix<S, 3, 1> generic_log_so3(const Eigen::Matrix<S, 3, 3>& m) {
  using std::atan2;
  using std::sqrt;
  const S trace = m.trace();
  S w;
  Eigen::Matrix<S, 3, 1> v;
  if (trace > S(0)) {
    const S t = sqrt(trace + S(1));
    w = t / S(2);
    v = Eigen::Matrix<S, 3, 1>(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)) / (S(2) * t);
  } else {
    int i = 0;
    if (m(1, 1) > m(0, 0)) i = 1;
    if (m(2, 2) > m(i, i)) i = 2;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const S t = sqrt(m(i, i) - m(j, j) - m(k, k) + S(1));
    v(i) = t / S(2);
    v(j) = (m(j, i) + m(i, j)) / (S(2) * t);
    v(k) = (m(k, i) + m(i, k)) / (S(2) * t);
    w = (m(k, j) - m(j, k)) / (S(2) * t);
    if (w < S(0)) {
      w = -w;
      v = -v;
    }
  }
  const S n2 = v.squaredNorm();
  if (n2 < S(1e-8)) return v * (S(2) / w * (S(1) - n2 / (S(3) * w * w)));
  const S n = sqrt(n2);
  return v * (S(2) * atan2(n, w) / n);
}

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/so3.ipp"
#endif
