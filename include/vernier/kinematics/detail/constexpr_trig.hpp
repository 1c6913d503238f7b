// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sine and cosine usable in constant expressions, so that a chain's table is ready at compile time.

#include <cmath>

#include "vernier/core/language.hpp"

namespace vernier::detail {

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of an angle below about 1e5 rad, to 2 ulp (range reduction in three parts, Taylor series).
/// The parts of pi/2 have 33 bits each, so that their product with a quadrant's number is exact.
constexpr SinCos constexpr_sincos(double angle) {
  constexpr double pio2 = 1.57079632679489655800e+00;
  constexpr double part1 = 1.57079632673412561417e+00;  // sum of the parts: pi/2
  constexpr double part2 = 6.07710050630396597660e-11;
  constexpr double part3 = 2.02226624879595063154e-21;
  const double scaled = angle / pio2;
  const auto quadrant = static_cast<long long>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
  const double k = static_cast<double>(quadrant);
  const double exact = angle - k * part1, rest = exact - k * part2;
  const double lost = (exact - rest) - k * part2;  // by the rounding of `rest`
  const double x = rest + (lost - k * part3), x2 = x * x;
  double sine = 0, cosine = 0;
  for (int n = 10; n >= 1; --n) {  // Horner, from the smallest term
    sine = -x2 / (2.0 * n * (2.0 * n + 1)) * (1 + sine);
    cosine = -x2 / ((2.0 * n - 1) * 2.0 * n) * (1 + cosine);
  }
  sine = x * (1 + sine);
  cosine = 1 + cosine;
  switch (((quadrant % 4) + 4) % 4) {
    case 0: return {sine, cosine};
    case 1: return {cosine, -sine};
    case 2: return {-sine, -cosine};
    default: return {-cosine, sine};
  }
}

}  // namespace vernier::detail
