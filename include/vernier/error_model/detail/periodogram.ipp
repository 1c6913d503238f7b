#pragma once

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

VERNIER_IMPL VectorX periodogram(const ConstVectorRef& angles, const ConstVectorRef& score,
                                 const ConstVectorRef& weight, int highest) {
  VectorX out(highest);
  const double sum = weight.sum();
  visit_orders(angles, highest, [&](int k, const Eigen::ArrayXd& c, const Eigen::ArrayXd& s) {
    const double gc = (score.array() * c).sum(), gs = (score.array() * s).sum();
    const double cc = (weight.array() * c * c).sum(), cs = (weight.array() * c * s).sum(), ss = sum - cc;
    const double determinant = cc * ss - cs * cs;
    out(k - 1) = determinant > 1e-6 * sum * sum ? (ss * gc * gc - 2 * cs * gc * gs + cc * gs * gs) / determinant : 0;
  });
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
