#pragma once

/// @file
/// Bases of functions of one joint's angle: what a transmission or an encoder may add to it.

#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// `cos(k q), sin(k q)`, k = 1 .. harmonics, in this order. No constant: that is the joint's zero.
struct Fourier {
  int harmonics = 60;  ///< K; 0 for no functions

  /// Number of functions, 2 K.
  Index size() const { return 2 * harmonics; }
  /// Expected size of the coefficient of function k, relative to that of the first harmonic: 1 / harmonic.
  double relative_size(Index k) const { return 1.0 / static_cast<double>(k / 2 + 1); }

  /// Calls `f(k, value, slope)` for each function; no allocation.
  template <class F>
  void visit(double q, F&& f) const noexcept {
    const double c1 = std::cos(q), s1 = std::sin(q);
    double c = 1, s = 0;
    for (int k = 1; k <= harmonics; ++k) {
      const double next = c * c1 - s * s1;
      s = c * s1 + s * c1;
      c = next;
      f(Index{2 * k - 2}, c, -k * s);
      f(Index{2 * k - 1}, s, k * c);
    }
  }

  /// Equal in every entry.
  bool operator==(const Fourier&) const = default;
};

/// Hidden nodes of an extreme learning machine that read one joint: `tanh(slope (q - centre))`.
struct JointNodes {
  VectorX centre;  ///< [rad]
  VectorX slope;   ///< [1/rad], as many

  /// Nodes spread evenly over [lower, upper], each as wide as their distance.
  static JointNodes spread(int nodes, double lower, double upper) {
    require(nodes >= 1 && lower < upper, "JointNodes: ", nodes, " nodes over [", lower, ", ", upper, "]");
    return {VectorX::LinSpaced(nodes, lower, upper),
            VectorX::Constant(nodes, static_cast<double>(nodes) / (upper - lower))};
  }

  /// Number of nodes.
  Index size() const { return centre.size(); }
  /// All nodes together are expected to be as large as a first harmonic.
  double relative_size(Index) const { return 1.0 / std::sqrt(static_cast<double>(size())); }

  /// Calls `f(k, value, slope)` for each node; no allocation.
  template <class F>
  void visit(double q, F&& f) const noexcept {
    for (Index k = 0; k < size(); ++k) {
      const double value = std::tanh(slope(k) * (q - centre(k)));
      f(k, value, slope(k) * (1 - value * value));
    }
  }

  /// Equal in every entry.
  bool operator==(const JointNodes& other) const { return centre == other.centre && slope == other.slope; }
};

/// Functions of one joint's angle.
using AngleBasis = std::variant<Fourier, JointNodes>;

/// Number of functions.
inline Index size_of(const AngleBasis& basis) {
  return std::visit([](const auto& b) { return b.size(); }, basis);
}

/// Value and slope of a combination of the functions of a basis.
struct AngleFunction {
  double value = 0;  ///< [rad]
  double slope = 0;  ///< [rad/rad]
};

/// `sum_k coefficients(k) h_k(q)`; no allocation.
inline AngleFunction combine(const AngleBasis& basis, const double* coefficients, double q) noexcept {
  AngleFunction out;
  const auto add = [&](Index k, double value, double slope) {
    out.value += coefficients[k] * value;
    out.slope += coefficients[k] * slope;
  };
  std::visit([&](const auto& b) { b.visit(q, add); }, basis);
  return out;
}

}  // namespace vernier
