// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A plain solver of ortho-parallel arms with a spherical wrist, by the published formulas, as a peer in the benchmark.

#include <array>
#include <cmath>
#include <numbers>

#include "vernier/core/types.hpp"

namespace bench {

/// Parameters and solutions as in the paper; tool z along joint 6, all joints zero with the arm straight up.
/// @cite Brandstoetter, Angerer and Hofbaur 2014
struct OpwSolver {
  double a1, a2, b, c1, c2, c3, c4;  ///< [m]

  /// Eight solutions, one a row; those that do not exist are not finite.
  std::array<std::array<double, 6>, 8> solve(const vernier::Isometry3& target) const noexcept {
    const vernier::Matrix3 e = target.linear();
    const vernier::Vector3 c = target.translation() - c4 * e.col(2);
    const double nx1 = std::sqrt(c.x() * c.x() + c.y() * c.y() - b * b) - a1, z = c.z() - c1;
    const double s1 = std::hypot(nx1, z), s2 = std::hypot(nx1 + 2 * a1, z), k = std::hypot(a2, c3);
    const double heading = std::atan2(c.y(), c.x()), offset = std::atan2(b, nx1 + a1);
    const double fore = std::atan2(a2, c3);
    const double up1 = std::acos((s1 * s1 + c2 * c2 - k * k) / (2 * s1 * c2)), at1 = std::atan2(nx1, z);
    const double up2 = std::acos((s2 * s2 + c2 * c2 - k * k) / (2 * s2 * c2)), at2 = std::atan2(nx1 + 2 * a1, z);
    const double bend1 = std::acos((s1 * s1 - c2 * c2 - k * k) / (2 * c2 * k));
    const double bend2 = std::acos((s2 * s2 - c2 * c2 - k * k) / (2 * c2 * k));
    const double q1[4] = {heading - offset, heading - offset, heading + offset - std::numbers::pi,
                          heading + offset - std::numbers::pi};
    const double q2[4] = {-up1 + at1, up1 + at1, -up2 - at2, up2 - at2};
    const double q3[4] = {bend1 - fore, -bend1 - fore, bend2 - fore, -bend2 - fore};
    std::array<std::array<double, 6>, 8> out;
    for (std::size_t i = 0; i < 4; ++i) {
      const double s = std::sin(q1[i]), co = std::cos(q1[i]), s23 = std::sin(q2[i] + q3[i]),
                   c23 = std::cos(q2[i] + q3[i]);
      const double m = e(0, 2) * s23 * co + e(1, 2) * s23 * s + e(2, 2) * c23;
      const double q4 = std::atan2(e(1, 2) * co - e(0, 2) * s, e(0, 2) * c23 * co + e(1, 2) * c23 * s - e(2, 2) * s23);
      const double q5 = std::atan2(std::sqrt(1 - m * m), m);
      const double q6 = std::atan2(e(0, 1) * s23 * co + e(1, 1) * s23 * s + e(2, 1) * c23,
                                   -e(0, 0) * s23 * co - e(1, 0) * s23 * s - e(2, 0) * c23);
      out[i] = {q1[i], q2[i], q3[i], q4, q5, q6};
      out[i + 4] = {q1[i], q2[i], q3[i], q4 + std::numbers::pi, -q5, q6 - std::numbers::pi};
    }
    return out;
  }
};

}  // namespace bench
