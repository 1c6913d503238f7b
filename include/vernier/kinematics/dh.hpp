// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Denavit-Hartenberg rows, tables and the two conventions.

#include <array>

#include "vernier/core/same_value.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Maximum number of joints of a chain, and so of the arrays on the stack that hold joint values.
inline constexpr int max_joints = 64;

/// One link: lengths in m, angles in rad. `beta` is Hayati's rotation about y for (nearly) parallel axes, zero
/// otherwise.
/// @cite Denavit and Hartenberg 1955; Hayati and Mirmirani 1985
struct DhRow {
  double a = 0;      ///< link length [m]
  double alpha = 0;  ///< link twist [rad]
  double d = 0;      ///< link offset [m]
  double theta = 0;  ///< joint angle at zero [rad]
  double beta = 0;   ///< Hayati's twist about y [rad]
  /// Whether the joint value is added to theta (revolute) or to d (prismatic).
  JointType joint = JointType::revolute;

  /// Equal in every value.
  constexpr bool operator==(const DhRow& other) const {
    return same_value(a, other.a) && same_value(alpha, other.alpha) && same_value(d, other.d) &&
           same_value(theta, other.theta) && same_value(beta, other.beta) && joint == other.joint;
  }
};

/// The five geometric parameters of a row, in the order in which a chain counts them.
enum class DhParameter { a, alpha, d, theta, beta };

namespace detail {

// Rows are counted from 1. The names of these functions are what a compiler says of a constant arm with such a value.
VERNIER_API [[noreturn]] void length_above_100_m_is_the_unit_right(int row, const char* name, double value);
VERNIER_API [[noreturn]] void angle_above_100_rad_is_the_unit_right(int row, const char* name, double value);

/// Refuses what robot files refuse: values that no arm has, because they are in millimetres or degrees.
template <std::size_t N>
constexpr void check_units(const std::array<DhRow, N>& rows) {
  const auto above_100 = [](double value) { return value > 100 || value < -100; };
  int number = 0;
  for (const DhRow& row : rows) {
    ++number;
    if (above_100(row.a)) length_above_100_m_is_the_unit_right(number, "a", row.a);
    if (above_100(row.d)) length_above_100_m_is_the_unit_right(number, "d", row.d);
    if (above_100(row.alpha)) angle_above_100_rad_is_the_unit_right(number, "alpha", row.alpha);
    if (above_100(row.theta)) angle_above_100_rad_is_the_unit_right(number, "theta", row.theta);
    if (above_100(row.beta)) angle_above_100_rad_is_the_unit_right(number, "beta", row.beta);
  }
}

}  // namespace detail

/// N rows; initialising it with any other number does not compile.
template <int N>
struct DhTable {
  /// Exactly N rows.
  /// @throws std::invalid_argument on a length above 100 m or an angle above 100 rad; a constant arm does not compile
  template <int M>
    requires(M == N)
  constexpr DhTable(const DhRow (&table)[M]) {  // NOLINT(google-explicit-constructor): so that `{{ {..}, {..} }}` reads
    for (int i = 0; i < N; ++i) rows[static_cast<std::size_t>(i)] = table[i];
    detail::check_units(rows);
  }
  /// Any other number of rows does not compile.
  template <int M>
    requires(M != N)
  constexpr DhTable(const DhRow (&)[M]) = delete;  // the number of rows is not the number of joints

  /// All rows.
  std::array<DhRow, N> rows{};
};

/// `T = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta)`: the classical convention.
struct StandardDh {
  /// Whether it is Craig's convention.
  static constexpr bool modified = false;
  /// The elementary motions of a row, from base to tool.
  static constexpr std::array<DhParameter, 5> order{DhParameter::theta, DhParameter::d, DhParameter::a,
                                                    DhParameter::alpha, DhParameter::beta};
};

/// `T = Rx(alpha) Tx(a) Ry(beta) Rz(theta) Tz(d)`: Craig's convention.
/// @cite Craig 2005
struct ModifiedDh {
  /// Whether it is Craig's convention.
  static constexpr bool modified = true;
  /// The elementary motions of a row, from base to tool.
  static constexpr std::array<DhParameter, 5> order{DhParameter::alpha, DhParameter::a, DhParameter::beta,
                                                    DhParameter::theta, DhParameter::d};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/dh.ipp"
#endif
