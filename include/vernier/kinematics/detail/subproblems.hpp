// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The subproblems of closed-form inverse kinematics: angles about given axes. Axes are unit vectors.
/// @cite Paden 1986; Kahan 1983; Elias and Wen 2025

#include <algorithm>
#include <cmath>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Rotation matrix by an angle [rad] about an axis.
VERNIER_API inline Matrix3 rotation_about(const Vector3& k, double angle) noexcept {
  const double s = std::sin(angle), c = std::cos(angle), x = k.x(), y = k.y(), z = k.z(), v = 1 - c;
  Matrix3 out;
  out << x * x * v + c, x * y * v - z * s, x * z * v + y * s,  //
      x * y * v + z * s, y * y * v + c, y * z * v - x * s,     //
      x * z * v - y * s, y * z * v + x * s, z * z * v + c;
  return out;
}

/// R v, inlined: here such a product takes a few nanoseconds, a call two more.
VERNIER_API inline Vector3 rotated(const Matrix3& r, const Vector3& v) noexcept {
  const double x = v.x(), y = v.y(), z = v.z();
  return {r(0, 0) * x + r(0, 1) * y + r(0, 2) * z, r(1, 0) * x + r(1, 1) * y + r(1, 2) * z,
          r(2, 0) * x + r(2, 1) * y + r(2, 2) * z};
}
/// R' v
VERNIER_API inline Vector3 rotated_back(const Matrix3& r, const Vector3& v) noexcept {
  const double x = v.x(), y = v.y(), z = v.z();
  return {r(0, 0) * x + r(1, 0) * y + r(2, 0) * z, r(0, 1) * x + r(1, 1) * y + r(2, 1) * z,
          r(0, 2) * x + r(1, 2) * y + r(2, 2) * z};
}
/// R S
VERNIER_API inline Matrix3 times3(const Matrix3& r, const Matrix3& s) noexcept {
  Matrix3 out;
  for (int c = 0; c < 3; ++c) {
    const double x = s(0, c), y = s(1, c), z = s(2, c);
    for (int i = 0; i < 3; ++i) out(i, c) = r(i, 0) * x + r(i, 1) * y + r(i, 2) * z;
  }
  return out;
}
/// R' S
VERNIER_API inline Matrix3 transposed_times3(const Matrix3& r, const Matrix3& s) noexcept {
  Matrix3 out;
  for (int c = 0; c < 3; ++c) {
    const double x = s(0, c), y = s(1, c), z = s(2, c);
    for (int i = 0; i < 3; ++i) out(i, c) = r(0, i) * x + r(1, i) * y + r(2, i) * z;
  }
  return out;
}

/// Some unit vector at right angles to a unit vector.
VERNIER_API inline Vector3 unit_orthogonal(const Vector3& v) noexcept {
  const Vector3 out = std::abs(v.z()) < 0.8 ? Vector3(-v.y(), v.x(), 0) : Vector3(0, -v.z(), v.y());
  return out / out.norm();
}

/// An angle that a subproblem determines, unless every angle solves it.
struct AngleAbout {
  double angle;  ///< [rad]
  bool any;      ///< whether no angle is better than another
};

/// Subproblem 1: the angle with `R(k, angle) a = b`; in the least-squares sense where a and b differ.
/// @param negligible distance from the axis at which a or b counts as on it
VERNIER_API inline AngleAbout angle_between(const Vector3& k, const Vector3& a, const Vector3& b,
                                            double negligible) noexcept {
  // from the parts at right angles to the axis: differences of larger numbers would leave nothing of them next to it
  const Vector3 u = k.cross(a), v = k.cross(b);
  return {std::atan2(k.dot(u.cross(v)), u.dot(v)), u.norm() < negligible || v.norm() < negligible};
}

/// By how much, relatively, a value lies beyond a bound; rounding errors do not count.
VERNIER_API inline double beyond(double value, double bound) noexcept {
  const double out = std::abs(value) / bound - 1;
  return out > 1e-12 ? out : 0;
}

/// Two angles, symmetric about a centre.
struct AnglePair {
  double centre, half;  ///< angles `centre + half` and `centre - half` [rad]
  double margin;        ///< by how much, relatively, no angle solves the equation; then `half` is that of the nearest
  bool any;             ///< whether every angle solves the equation, or none
  double radius;        ///< of the circle on which the point moves, as far as it matters
};

/// Subproblem 4: the angles with `h . R(k, angle) p = d`.
/// @param negligible length of p's part at right angles to k, seen along h, that counts as zero
VERNIER_API inline AnglePair angles_to_plane(const Vector3& h, const Vector3& k, const Vector3& p, double d,
                                             double negligible) noexcept {
  const double along = k.dot(p) * h.dot(k);
  const Vector3 u = k.cross(p), v = k.cross(h);
  const double sine = k.dot(u.cross(v)), cosine = u.dot(v), rest = d - along;
  const double r = std::sqrt(sine * sine + cosine * cosine);
  if (r < negligible) return {0, 0, std::abs(rest) <= negligible ? 0 : std::abs(rest) / negligible, true, r};
  return {std::atan2(sine, cosine), std::atan2(std::sqrt((std::max)((r - rest) * (r + rest), 0.0)), rest),
          beyond(rest, r), false, r};
}

/// Subproblem 3: the angles with `|R(k, angle) a - b| = d`.
VERNIER_API inline AnglePair angles_to_distance(const Vector3& k, const Vector3& a, const Vector3& b, double d,
                                                double negligible) noexcept {
  const Vector3 u = k.cross(a), v = k.cross(b);
  const double along = k.dot(a) * k.dot(b), sine = k.dot(u.cross(v)), cosine = u.dot(v);
  const double rest = 0.5 * (a.squaredNorm() + b.squaredNorm() - d * d) - along;
  const double r = std::sqrt(sine * sine + cosine * cosine);
  if (const double longer = (std::max)(u.norm(), v.norm()); r < negligible * longer || longer < negligible) {
    const double scale = negligible * (std::max)({a.norm(), b.norm(), d});
    return {0, 0, std::abs(rest) <= scale ? 0 : std::abs(rest) / scale, true, r};
  }
  return {std::atan2(sine, cosine), std::atan2(std::sqrt((std::max)((r - rest) * (r + rest), 0.0)), rest),
          beyond(rest, r), false, r};
}

}  // namespace vernier::detail
