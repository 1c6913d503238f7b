#pragma once

#include <cmath>

#include "vernier/error_terms/fourier.hpp"

namespace vernier {

namespace detail {

/// Calls `f(k, cos(k q), sin(k q))` for k = 1 .. harmonics, by rotating a unit vector.
template <class F>
void visit_harmonics(int harmonics, double q, const F& f) noexcept {
  const double c1 = std::cos(q), s1 = std::sin(q);
  double c = 1, s = 0;
  for (int k = 1; k <= harmonics; ++k) {
    const double next = c * c1 - s * s1;
    s = c * s1 + s * c1;
    c = next;
    f(k, c, s);
  }
}

}  // namespace detail

VERNIER_IMPL void Fourier::values(double q, double* out) const noexcept {
  detail::visit_harmonics(harmonics, q, [&](int k, double c, double s) {
    out[2 * k - 2] = c;
    out[2 * k - 1] = s;
  });
}

VERNIER_IMPL Fourier::Sum Fourier::sum(double q, const double* coefficients) const noexcept {
  Sum out;
  detail::visit_harmonics(harmonics, q, [&](int k, double c, double s) {
    const double a = coefficients[2 * k - 2], b = coefficients[2 * k - 1];
    out.value += a * c;
    out.slope += a * (-k * s);
    out.value += b * s;
    out.slope += b * (k * c);
  });
  return out;
}

}  // namespace vernier
