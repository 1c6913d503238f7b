#pragma once

/// @file
/// Harmonics of a joint's angle: what a transmission or an encoder may add to it.

#include "vernier/core/types.hpp"

namespace vernier {

/// `cos(k q), sin(k q)`, k = 1 .. harmonics, in this order. No constant: that is the joint's zero.
struct Fourier {
  int harmonics = 60;  ///< K; 0 for no functions

  /// Number of functions, 2 K.
  Index size() const { return 2 * harmonics; }
  /// Expected amplitude of function k relative to that of the first harmonic: 1 / harmonic.
  static double relative_amplitude(Index k) { return 1.0 / static_cast<double>(k / 2 + 1); }

  /// Values of the functions at q, size() of them.
  VERNIER_API void values(double q, double* out) const noexcept;

  /// Value and slope of a combination of the functions.
  struct Sum {
    double value = 0;  ///< [rad]
    double slope = 0;  ///< [rad/rad]
  };
  /// `sum_k coefficients(k) h_k(q)`; no allocation.
  VERNIER_API Sum sum(double q, const double* coefficients) const noexcept;

  /// Equal in every entry.
  bool operator==(const Fourier&) const = default;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/fourier.ipp"
#endif
