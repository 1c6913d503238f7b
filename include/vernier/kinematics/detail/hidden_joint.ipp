// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vernier/core/so3.hpp"
#include "vernier/kinematics/detail/hidden_joint.hpp"
#include "vernier/kinematics/detail/reflections.hpp"
#include "vernier/kinematics/detail/small_systems.hpp"

namespace vernier::detail {

VERNIER_IMPL Isometry3 turn_about(const AxisLine& axis, double angle) noexcept {
  const Matrix3 turn = exp_so3(Vector3(angle * axis.direction));
  return rigid_motion(turn, axis.point - rotated(turn, axis.point));
}

VERNIER_IMPL Isometry3 to_z_axis(const AxisLine& line) noexcept {
  const Vector3 x = unit_orthogonal(line.direction), y = line.direction.cross(x);
  Matrix3 turn;
  for (int c = 0; c < 3; ++c) {
    turn(0, c) = x(c);
    turn(1, c) = y(c);
    turn(2, c) = line.direction(c);
  }
  return rigid_motion(turn, -rotated(turn, line.point));
}

VERNIER_IMPL LineCoordinates coordinates_of(const AxisLine& line) noexcept {
  const Vector3 &p = line.point, &l = line.direction;
  const double pp = p.dot(p), pl = p.dot(l);
  const Vector3 m = p.cross(l),
                f(pp * l.x() - 2 * pl * p.x(), pp * l.y() - 2 * pl * p.y(), pp * l.z() - 2 * pl * p.z());
  return {p.x(), l.x(), m.x(), f.x(), p.y(), l.y(), m.y(), f.y(), p.z(), l.z(), m.z(), f.z(), pp, pl};
}

/// The coordinates of a line turned about `inner` and then about `outer`, as coefficients, a column each, of the
/// products of (1, cos, sin) of the outer and of the inner angle. They follow from three angles each, a third of a turn
/// apart.
VERNIER_LOCAL void turned_twice(const AxisLine& outer, const AxisLine& inner, const AxisLine& line,
                                double (&out)[9][14]) noexcept {
  constexpr double angles[3] = {0, 2 * std::numbers::pi / 3, -2 * std::numbers::pi / 3};
  std::fill_n(out[0], 9 * 14, 0.0);
  Isometry3 outer_turns[3];
  for (int j = 0; j < 3; ++j) outer_turns[j] = turn_about(outer, angles[j]);
  for (const double b : angles) {
    const AxisLine once = turn_about(inner, b) * line;
    for (int j = 0; j < 3; ++j) {
      const LineCoordinates sample = coordinates_of(outer_turns[j] * once);
      const double outer_weights[3] = {1. / 3, 2. / 3 * std::cos(angles[j]), 2. / 3 * std::sin(angles[j])};
      const double inner_weights[3] = {1. / 3, 2. / 3 * std::cos(b), 2. / 3 * std::sin(b)};
      for (int column = 0; column < 9; ++column) {
        const double weight = outer_weights[column / 3] * inner_weights[column % 3];
        for (std::size_t i = 0; i < 14; ++i) out[column][i] += weight * sample[i];
      }
    }
  }
}

/// The first rows of a, over the products of (1, cos 2h, sin 2h) with anything, times cos h and, below, times sin h:
/// rows over those of (cos 3h, sin 3h, cos h, sin h).
template <int Rows, int All>
void times_half_angle(const double (&a)[9][All], double (&out)[12][2 * Rows]) noexcept {
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < Rows; ++i) {
      const double one = a[k][i], c = a[3 + k][i] / 2, s = a[6 + k][i] / 2;
      out[k][i] = c, out[k][Rows + i] = -s;
      out[3 + k][i] = s, out[3 + k][Rows + i] = c;
      out[6 + k][i] = one + c, out[6 + k][Rows + i] = s;
      out[9 + k][i] = s, out[9 + k][Rows + i] = one - c;
    }
}

VERNIER_IMPL LoopPencil eliminate(const ClosedLoop& loop) noexcept {
  // E_3 E_4 E_5 (line 6) = E_2^-1 E_1^-1 closure (line 6), as E_6 does not move its own axis. Combinations of the 14
  // equations without the eight terms in joints 1 and 2 are the left null space of those terms.
  const auto& axes = loop.axes;
  const auto reversed = [](const AxisLine& line) { return AxisLine{line.point, -line.direction}; };
  double left[9][14], right[9][14], eliminated[8][14], combinations[6][14], constant[9][6];
  turned_twice(axes[3], axes[4], axes[5], left);
  turned_twice(reversed(axes[1]), reversed(axes[0]), loop.closure * axes[5], right);
  std::copy_n(right[1], 8 * 14, eliminated[0]);
  orthogonal_complement(eliminated[0], 14, 8, 8, combinations[0]);

  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 6; ++i) {
      constant[j][i] = 0;
      for (int k = 8; k < 14; ++k) constant[j][i] += combinations[i][k] * left[j][k];
    }
  LoopPencil out;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 14; ++k) constant[0][i] -= combinations[i][k] * right[0][k];
    for (int k = 0; k < 8; ++k) out.equation[k][i] = combinations[i][k];
  }
  times_half_angle<6>(constant, out.constant);
  times_half_angle<8>(left, out.turning);
  return out;
}

/// What turns with joint 3, turned [rad].
VERNIER_LOCAL void turned_by(const LoopPencil& pencil, double q3, double (&out)[12][16]) noexcept {
  const double c = std::cos(q3), s = std::sin(q3);
  for (int j = 0; j < 12; ++j)
    for (int half = 0; half < 16; half += 8) {
      const double *const x = pencil.turning[j] + half, *const y = x + 4;
      for (int i = 0; i < 4; ++i) {
        out[j][half + i] = c * x[i] - s * y[i];
        out[j][half + 4 + i] = s * x[i] + c * y[i];
      }
    }
}

VERNIER_IMPL void equations_at(const LoopPencil& pencil, double q3, double (&out)[12][12]) noexcept {
  double turned[12][16];
  turned_by(pencil, q3, turned);
  for (int j = 0; j < 12; ++j)
    for (const int half : {0, 1}) {
      FewNumbers<6> sum(pencil.constant[j] + 6 * half);
      VERNIER_UNROLL
      for (int k = 0; k < 8; ++k) sum.add(turned[j][8 * half + k], FewNumbers<6>(pencil.equation[k]));
      sum.store(out[j] + 6 * half);
    }
}

/// Largest sum of a column's absolute values.
VERNIER_LOCAL inline double column_sum_norm(const double (&a)[12][12]) noexcept {
  double out = 0;
  for (const auto& column : a) {
    double sum = 0;
    for (const double value : column) sum += std::abs(value);
    if (sum > out || std::isnan(sum)) out = sum;
  }
  return out;
}

VERNIER_IMPL HiddenJointValues hidden_joint_values(const LoopPencil& pencil) noexcept {
  // With B, W, Y the parts of the pencil, R the turn by q3 / 2 and u = R Y x, (B + W R^2 Y) x = 0 becomes
  //     t u = -J (1 + 2 Y M^-1 W) u,    M = B - W Y the pencil at half a turn, J a quarter turn, t = tan(q3 / 2).
  // Another origin of q3 only turns Y.
  constexpr double pi = std::numbers::pi;
  constexpr int origins = 5;
  HiddenJointValues out;
  double matrix[12][12], inverses[2][12][12];
  int best = 0;
  double best_inverse_condition = 0, origin = 0;
  for (int k = 0; k < origins; ++k) {
    const double candidate = 0.3 + 2 * pi / origins * k;  // 0.3: zeros of catalogue arms are special
    auto& inverse = inverses[1 - best];
    equations_at(pencil, candidate + pi, matrix);
    const double norm = column_sum_norm(matrix);
    invert_few<12>(matrix[0], inverse[0]);
    const double inverse_condition = 1 / (norm * column_sum_norm(inverse));
    if (inverse_condition > best_inverse_condition) {  // false for NaN too
      best_inverse_condition = inverse_condition;
      best = 1 - best;
      origin = candidate;
    }
  }
  out.condition = best_inverse_condition > 0 ? 1 / best_inverse_condition : std::numeric_limits<double>::infinity();
  if (!(best_inverse_condition > 0)) return out;

  double turned[12][16], a[16][16];
  turned_by(pencil, origin, turned);
  bool finite = true;
  for (int j = 0; j < 16; ++j) {
    double solved[12], doubled[16];
    multiply_few<12, 6>(inverses[best][j < 8 ? 0 : 6], pencil.equation[j % 8], solved);
    multiply_few<16, 12>(turned[0], solved, doubled);
    for (int i = 0; i < 16; ++i) {
      doubled[i] = 2 * doubled[i] + (i == j ? 1 : 0);
      finite = finite && std::isfinite(doubled[i]);
    }
    for (int i = 0; i < 16; ++i) a[j][i] = i % 8 < 4 ? doubled[i + 4] : -doubled[i - 4];
  }
  if (!finite) return out;
  double work[16];
  std::complex<double> tangents[16];
  to_hessenberg(a[0], 16, work);
  if (!hessenberg_eigenvalues(a[0], 16, tangents)) return out;
  for (const std::complex<double> tangent : tangents)
    out.angles[static_cast<std::size_t>(out.count++)] = origin + 2. * std::atan(tangent);
  return out;
}

}  // namespace vernier::detail
