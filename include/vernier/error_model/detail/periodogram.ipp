// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/error_model/detail/periodogram.hpp"

namespace vernier::detail {

/// Cosines and sines of all angles times an order.
struct Waves {
  VectorX cosine, sine;
};

VERNIER_LOCAL Waves waves(const VectorX& angles, int order) {
  Waves out{angles, angles};
  for (Index i = 0; i < angles.size(); ++i) {
    out.cosine(i) = std::cos(order * angles(i));
    out.sine(i) = std::sin(order * angles(i));
  }
  return out;
}

/// Cosines and sines of sums of two angles each, in place.
VERNIER_LOCAL inline void turn_waves(Index n, const double* by_cosine, const double* by_sine, double* cosine,
                                     double* sine) {
  for (Index i = 0; i < n; ++i) {
    const double c = cosine[i], s = sine[i];
    cosine[i] = c * by_cosine[i] - s * by_sine[i];
    sine[i] = s * by_cosine[i] + c * by_sine[i];
  }
}

/// Calls `f(k, c, s)` for the orders 1 .. highest, c and s the cosines and sines of all angles.
template <class F>
void visit_orders(const VectorX& angles, int highest, const F& f) {
  const Waves first = waves(angles, 1);
  Waves now = waves(angles, 0);
  for (int k = 1; k <= highest; ++k) {
    if (k % 256 == 0)  // rounding of the recursion
      now = waves(angles, k);
    else
      turn_waves(angles.size(), first.cosine.data(), first.sine.data(), now.cosine.data(), now.sine.data());
    f(k, now.cosine, now.sine);
  }
}

/// The regression of a score on one order.
struct OrderFit {
  double cosine = 0, sine = 0, chi_square = 0;
};

VERNIER_LOCAL OrderFit fit_order(const VectorX& score, const VectorX& weight, double sum, const VectorX& c,
                                 const VectorX& s) {
  const double gc = score.dot(c), gs = score.dot(s);
  const double cc = VERNIER_LATER(weight).cwiseProduct(c).dot(c), cs = VERNIER_LATER(weight).cwiseProduct(c).dot(s),
               ss = sum - cc;
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 1e-6 * sum * sum)) return {};
  const double a = (ss * gc - cs * gs) / determinant, b = (cc * gs - cs * gc) / determinant;
  return {a, b, a * gc + b * gs};
}

VERNIER_IMPL VectorX periodogram(const VectorX& angles, const VectorX& score, const VectorX& weight, int highest) {
  VectorX out(highest);
  const double sum = weight.sum();
  visit_orders(angles, highest, [&](int k, const VectorX& c, const VectorX& s) {
    out(k - 1) = fit_order(score, weight, sum, c, s).chi_square;
  });
  return out;
}

VERNIER_IMPL std::vector<int> lines_of_residuals(const VectorX& angles, VectorX score, const VectorX& weight,
                                                 const std::vector<int>& known, int highest, double threshold) {
  constexpr std::size_t most = 8;
  std::vector<int> out;
  while (out.size() < most) {
    VectorX power = periodogram(angles, score, weight, highest);
    for (const int order : known)
      if (order <= highest) power(order - 1) = 0;
    Index largest = 0;
    if (!(VERNIER_LATER(power).maxCoeff(&largest) > threshold)) break;
    const auto order = static_cast<int>(largest + 1);
    if (std::find(out.begin(), out.end(), order) != out.end()) break;
    out.push_back(order);
    const Waves wave = waves(angles, order);
    const OrderFit fit = fit_order(score, weight, weight.sum(), wave.cosine, wave.sine);
    for (Index i = 0; i < score.size(); ++i)
      score(i) -= weight(i) * (fit.cosine * wave.cosine(i) + fit.sine * wave.sine(i));
  }
  return out;
}

VERNIER_IMPL bool tells_orders_apart(const VectorX& angles, const VectorX& weight, int highest) {
  constexpr int close = 40;  // neighbours are alike over a part of a turn
  const double sum = weight.sum();
  bool out = sum > 0;
  visit_orders(angles, 2 * highest, [&](int k, const VectorX& c, const VectorX& s) {
    if (k >= close) out = out && std::hypot(weight.dot(c), weight.dot(s)) < 0.5 * sum;
  });
  return out;
}

}  // namespace vernier::detail
