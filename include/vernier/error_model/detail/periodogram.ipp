#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/error_model/detail/periodogram.hpp"

namespace vernier::detail {

/// Calls `f(k, c, s)` for the orders 1 .. highest, c and s the cosines and sines of all angles.
template <class F>
void visit_orders(const ConstVectorRef& angles, int highest, const F& f) {
  using Array = Eigen::ArrayXd;
  const Array first_cos = angles.array().cos(), first_sin = angles.array().sin();
  Array c = Array::Ones(angles.size()), s = Array::Zero(angles.size()), next(angles.size());
  for (int k = 1; k <= highest; ++k) {
    if (k % 256 == 0) {  // rounding of the recursion
      c = (k * angles.array()).cos();
      s = (k * angles.array()).sin();
    } else {
      next = c * first_cos - s * first_sin;
      s = s * first_cos + c * first_sin;
      c = next;
    }
    f(k, c, s);
  }
}

/// The regression of a score on one order.
struct OrderFit {
  double cosine = 0, sine = 0, chi_square = 0;
};

VERNIER_API OrderFit fit_order(const ConstVectorRef& score, const ConstVectorRef& weight, double sum,
                               const Eigen::ArrayXd& c, const Eigen::ArrayXd& s) {
  const double gc = (score.array() * c).sum(), gs = (score.array() * s).sum();
  const double cc = (weight.array() * c * c).sum(), cs = (weight.array() * c * s).sum(), ss = sum - cc;
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 1e-6 * sum * sum)) return {};
  const double a = (ss * gc - cs * gs) / determinant, b = (cc * gs - cs * gc) / determinant;
  return {a, b, a * gc + b * gs};
}

VERNIER_IMPL VectorX periodogram(const ConstVectorRef& angles, const ConstVectorRef& score,
                                 const ConstVectorRef& weight, int highest) {
  VectorX out(highest);
  const double sum = weight.sum();
  visit_orders(angles, highest, [&](int k, const Eigen::ArrayXd& c, const Eigen::ArrayXd& s) {
    out(k - 1) = fit_order(score, weight, sum, c, s).chi_square;
  });
  return out;
}

VERNIER_IMPL std::vector<int> lines_of_residuals(const ConstVectorRef& angles, VectorX score,
                                                 const ConstVectorRef& weight, const std::vector<int>& known,
                                                 int highest, double threshold) {
  constexpr std::size_t most = 8;
  std::vector<int> out;
  while (out.size() < most) {
    VectorX power = periodogram(angles, score, weight, highest);
    for (const int order : known)
      if (order <= highest) power(order - 1) = 0;
    Index largest = 0;
    if (!(power.maxCoeff(&largest) > threshold)) break;
    const auto order = static_cast<int>(largest + 1);
    if (std::find(out.begin(), out.end(), order) != out.end()) break;
    out.push_back(order);
    const Eigen::ArrayXd c = (order * angles.array()).cos(), s = (order * angles.array()).sin();
    const OrderFit fit = fit_order(score, weight, weight.sum(), c, s);
    score.array() -= weight.array() * (fit.cosine * c + fit.sine * s);
  }
  return out;
}

VERNIER_IMPL bool tells_orders_apart(const ConstVectorRef& angles, const ConstVectorRef& weight, int highest) {
  constexpr int close = 40;  // neighbours are alike over a part of a turn
  const double sum = weight.sum();
  bool out = sum > 0;
  visit_orders(angles, 2 * highest, [&](int k, const Eigen::ArrayXd& c, const Eigen::ArrayXd& s) {
    if (k >= close) out = out && std::hypot((weight.array() * c).sum(), (weight.array() * s).sum()) < 0.5 * sum;
  });
  return out;
}

}  // namespace vernier::detail
