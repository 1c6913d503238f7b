#pragma once

/// @file
/// Denavit-Hartenberg rows, tables and the two conventions.

#include <array>

#include "vernier/core/types.hpp"

namespace vernier {

/// Maximum number of joints of a chain.
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
  bool operator==(const DhRow&) const = default;
};

/// The five geometric parameters of a row, in the order in which a chain counts them.
enum class DhParameter { a, alpha, d, theta, beta };

/// N rows; initialising it with any other number does not compile.
template <int N>
struct DhTable {
  /// Exactly N rows.
  template <int M>
    requires(M == N)
  constexpr DhTable(const DhRow (&table)[M]) {  // NOLINT(google-explicit-constructor): so that `{{ {..}, {..} }}` reads
    for (int i = 0; i < N; ++i) rows[static_cast<std::size_t>(i)] = table[i];
  }

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
