// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Harmonics of a joint's angle: errors of a transmission or an encoder, and the expected size of each order.

#include <vector>

#include "vernier/core/same_value.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// `cos(k q), sin(k q)` for some orders k, in this order. No constant: that is the joint's zero.
struct Fourier {
  std::vector<int> orders{};  ///< ascending, each at least 1 and once; empty for no functions

  /// Orders 1 .. highest.
  VERNIER_API static Fourier up_to(int highest);

  /// Number of functions, two an order.
  Index size() const { return 2 * static_cast<Index>(orders.size()); }
  /// Order of function k.
  int order(Index k) const { return orders[static_cast<std::size_t>(k / 2)]; }

  /// Values of the functions at q, size() of them.
  VERNIER_API void values(double q, double* out) const noexcept;

  /// Value and slope of a combination of the functions.
  struct Sum {
    double value = 0;  ///< [rad]
    double slope = 0;  ///< [rad/rad]
  };
  /// `sum_k coefficients(k) h_k(q)`; no allocation.
  VERNIER_API Sum sum(double q, const double* coefficients) const noexcept;

  /// @throws std::invalid_argument naming an order that is not above the one before it
  VERNIER_API void validate() const;

  /// Equal in every entry.
  bool operator==(const Fourier&) const = default;
};

/// Expected size of the harmonics of a band of orders.
struct HarmonicBand {
  int first;   ///< lowest order
  int last;    ///< highest order
  double std;  ///< of each coefficient [rad]

  /// Equal in every entry.
  constexpr bool operator==(const HarmonicBand& other) const {
    return first == other.first && last == other.last && same_value(std, other.std);
  }
};

/// Expected sizes of harmonics by bands of orders; where bands overlap, the last one holds.
using HarmonicSpectrum = std::vector<HarmonicBand>;

/// The spectrum found at gears and encoders of industrial arms: all orders up to 140, the largest up to 28; and lines
/// of encoders with 128 signal periods a turn (orders 128 and 256) and of strain-wave gears of ratio 101:1, four
/// periods a turn of their input (order 404).
/// @cite Heydemann 1981; Tuttle and Seering 1996
VERNIER_API HarmonicSpectrum typical_spectrum();

/// All orders of a spectrum up to a highest one.
VERNIER_API Fourier orders_of(const HarmonicSpectrum& spectrum, int highest);

/// Expected size of an order's coefficients [rad]; 0 outside all bands.
VERNIER_API double expected_std(const HarmonicSpectrum& spectrum, int order);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/fourier.ipp"
#endif
