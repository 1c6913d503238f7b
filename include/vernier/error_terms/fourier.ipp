// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/error_terms/fourier.hpp"

namespace vernier {

namespace detail {

/// Calls `f(i, k, cos(k q), sin(k q))` for the orders k, by rotating a unit vector; gaps by its powers.
template <class F>
void visit_harmonics(const std::vector<int>& orders, double q, const F& f) noexcept {
  struct Rotation {
    double c, s;
    void turn(const Rotation& by) {
      const double next = c * by.c - s * by.s;
      s = c * by.s + s * by.c;
      c = next;
    }
  };
  const Rotation one{std::cos(q), std::sin(q)};
  Rotation now{1, 0};
  int at = 0;
  for (std::size_t i = 0; i < orders.size(); ++i) {
    Rotation power = one;
    for (int rest = orders[i] - at; rest > 0; rest >>= 1) {
      if (rest & 1) now.turn(power);
      if (rest > 1) power.turn(Rotation(power));
    }
    at = orders[i];
    f(i, at, now.c, now.s);
  }
}

}  // namespace detail

VERNIER_IMPL Fourier Fourier::up_to(int highest) {
  Fourier out;
  for (int k = 1; k <= highest; ++k) out.orders.push_back(k);
  return out;
}

VERNIER_IMPL void Fourier::validate() const {
  int before = 0;
  for (const int order : orders) {
    demand(order > before, "Fourier: order ", order, " after ", before, ", must ascend from 1");
    before = order;
  }
}

VERNIER_IMPL void Fourier::values(double q, double* out) const noexcept {
  detail::visit_harmonics(orders, q, [&](std::size_t i, int, double c, double s) {
    out[2 * i] = c;
    out[2 * i + 1] = s;
  });
}

VERNIER_IMPL Fourier::Sum Fourier::sum(double q, const double* coefficients) const noexcept {
  Sum out;
  detail::visit_harmonics(orders, q, [&](std::size_t i, int k, double c, double s) {
    const double a = coefficients[2 * i], b = coefficients[2 * i + 1];
    out.value += a * c;
    out.slope += a * (-k * s);
    out.value += b * s;
    out.slope += b * (k * c);
  });
  return out;
}

VERNIER_IMPL HarmonicSpectrum typical_spectrum() {
  return {{1, 3, 150e-6},    {4, 6, 50e-6},     {7, 28, 70e-6},   {29, 40, 16e-6},  {41, 60, 8e-6},
          {61, 140, 3.3e-6}, {126, 130, 10e-6}, {254, 258, 6e-6}, {400, 408, 12e-6}};
}

VERNIER_IMPL double expected_std(const HarmonicSpectrum& spectrum, int order) {
  double std = 0;
  for (const HarmonicBand& band : spectrum)
    if (order >= band.first && order <= band.last) std = band.std;
  return std;
}

VERNIER_IMPL Fourier orders_of(const HarmonicSpectrum& spectrum, int highest) {
  int last = 0;
  for (const HarmonicBand& band : spectrum) last = (std::max)(last, (std::min)(band.last, highest));
  Fourier out;
  for (int order = 1; order <= last; ++order)
    if (expected_std(spectrum, order) > 0) out.orders.push_back(order);
  return out;
}

}  // namespace vernier
