// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/quantile.hpp"

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/same_value.hpp"

namespace vernier {

VERNIER_IMPL double quantile(const ConstVectorRef& values, double probability) {
  demand(values.size() >= 1, "quantile: no values");
  demand(probability >= 0 && probability <= 1, "quantile: probability is ", probability, ", must lie in [0, 1]");
  for (Index i = 0; i < values.size(); ++i) demand(!std::isnan(values(i)), "quantile: value ", i, " is not a number");
  VectorX sorted = values;
  std::sort(sorted.begin(), sorted.end());
  return detail::quantile_of_sorted(sorted, probability);
}

VERNIER_IMPL double radius_95(const Matrix3& covariance) noexcept {
  const Matrix3 square = covariance * covariance;
  const double mean = covariance.trace(), variance = 2 * square.trace();
  if (!(mean > 0)) return mean >= 0 ? 0 : std::nan("");
  const double degrees = 2 * mean * mean / variance, z = 1.6448536269514722;  // 95 % of a standard normal
  const double spread = 2 / (9 * degrees);
  return std::sqrt(mean * std::pow(1 - spread + z * std::sqrt(spread), 3));
}

VERNIER_IMPL double detail::quantile_of_sorted(const ConstVectorRef& values, double probability) {
  const double at = probability * static_cast<double>(values.size() - 1);
  const auto below = static_cast<Index>(at);
  const double low = values(below), high = values((std::min)(below + 1, values.size() - 1));
  const double share = at - static_cast<double>(below);
  return share <= 0 || same_value(low, high) ? low : low + share * (high - low);  // no difference of infinite values
}

}  // namespace vernier
