#pragma once

/// @file
/// Sine and cosine usable in constant expressions, so that a chain's table is ready at compile time.

#include <cmath>

namespace vernier::detail {

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of an angle below about 1e5 rad, to 1 ulp or so (range reduction in two parts, Taylor series).
constexpr SinCos constexpr_sincos(double angle) {
  constexpr double pio2_high = 1.57079632679489655800e+00, pio2_low = 6.12323399573676603587e-17;
  const double scaled = angle / pio2_high;
  const auto quadrant = static_cast<long long>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
  const double k = static_cast<double>(quadrant);
  const double x = (angle - k * pio2_high) - k * pio2_low, x2 = x * x;
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
