// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/evaluation/chi_square.hpp"

namespace vernier {

VERNIER_IMPL double chi_square_tail(double x, double dof) {
  demand(dof > 0 && std::isfinite(dof), "chi_square_tail: ", dof, " degrees of freedom must be positive");
  demand(x >= 0, "chi_square_tail: ", x, " must not be negative");
  if (x <= 0) return 1;
  if (std::isinf(x)) return 0;
  const double a = dof / 2, z = x / 2, front = std::exp(a * std::log(z) - z - std::lgamma(a));
  constexpr int most = 100000;
  if (z < a + 1) {  // 1 - P by its series
    double term = 1 / a, sum = term;
    for (int k = 1; k < most && term > 1e-17 * sum; ++k) {
      term *= z / (a + k);
      sum += term;
    }
    return std::fmin(1, std::fmax(0, 1 - front * sum));
  }
  // the continued fraction, by Lentz' method
  double b = z + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int k = 1; k < most; ++k) {
    const double step = -k * (k - a);
    b += 2;
    d = 1 / (step * d + b);
    c = b + step / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return front * h;
}

}  // namespace vernier
