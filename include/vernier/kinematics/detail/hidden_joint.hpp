// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Elimination: of six turns that close a loop, the values that the third may have.

#include <array>
#include <complex>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

/// The axis of a joint.
struct AxisLine {
  Vector3 point;      ///< any point on it
  Vector3 direction;  ///< unit vector; the joint turns about it by the right-hand rule
};

/// A line moved.
VERNIER_API inline AxisLine operator*(const Isometry3& motion, const AxisLine& line) {
  return {transformed(motion, line.point), rotated(rotation(motion), line.direction)};
}

/// The turn about an axis by an angle [rad].
VERNIER_API Isometry3 turn_about(const AxisLine& axis, double angle) noexcept;

/// A motion that takes a line to the z-axis.
VERNIER_API Isometry3 to_z_axis(const AxisLine& line) noexcept;

/// A line of direction l with a marked point p, in 14 coordinates: the x of p, l, m = p x l and
/// f = (p.p) l - 2 (p.l) p, their y, their z, p.p and p.l. A motion maps (1, coordinates) linearly, for (1, p, p.p) are
/// the conformal coordinates of the point and (l, m, f, p.l) those of the tangent there. So a turn by q is of first
/// degree in cos q and sin q; if about z, it turns the four pairs of x and y and leaves the other six alone.
/// @cite Raghavan and Roth 1993
using LineCoordinates = std::array<double, 14>;
VERNIER_API LineCoordinates coordinates_of(const AxisLine& line) noexcept;

/// Six turns E_i about axes whose product is given: E_1 E_2 ... E_6 = closure. Axis 3 is the z-axis.
struct ClosedLoop {
  std::array<AxisLine, 6> axes;
  Isometry3 closure;
};

/// The loop without its joints 1, 2 and 6: twelve equations `equations_at(q3) x = 0`, linear in the products x of
/// (cos 3h, sin 3h, cos h, sin h), h = q4 / 2, and (1, cos q5, sin q5). Half angles instead of their tangents keep half
/// turns from being infinite and the matrices balanced.
struct LoopPencil {
  double constant[12][12];  ///< what does not turn with joint 3; columns, as all of these
  double equation[8][6];    ///< how what turns enters six equations, its first half the first six
  double turning[12][16];   ///< what turns: twice the x of p, l, m and f, and their y
};

VERNIER_API LoopPencil eliminate(const ClosedLoop& loop) noexcept;

/// The twelve equations where joint 3 has a value [rad], in columns.
VERNIER_API void equations_at(const LoopPencil& pencil, double q3, double (&out)[12][12]) noexcept;

/// The values of joint 3 with which a pencil is singular, complex ones among them.
struct HiddenJointValues {
  std::array<std::complex<double>, 16> angles;  ///< [rad]; the first `count` are set
  int count = 0;                                ///< 16, or 0 where the arithmetic broke down
  double condition = 0;                         ///< of the matrix inverted; infinite if it is singular
};

/// As the eigenvalues t = tan((q3 - origin) / 2) of a matrix, for the origin where it is conditioned best. What turns
/// with joint 3 has half the rank of the usual pencil of 24 rows, so 16 rows suffice and no eigenvalue is spurious.
/// @cite Manocha and Canny 1994; Kohli and Osvatic 1993
VERNIER_API HiddenJointValues hidden_joint_values(const LoopPencil& pencil) noexcept;

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/hidden_joint.ipp"
#endif
