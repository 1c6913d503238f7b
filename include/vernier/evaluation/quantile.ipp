#pragma once

#include "vernier/evaluation/quantile.hpp"

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"

namespace vernier {

VERNIER_IMPL double quantile(const ConstVectorRef& values, double probability) {
  require(values.size() >= 1, "quantile: no values");
  require(probability >= 0 && probability <= 1, "quantile: probability is ", probability, ", must lie in [0, 1]");
  for (Index i = 0; i < values.size(); ++i) require(!std::isnan(values(i)), "quantile: value ", i, " is not a number");
  VectorX sorted = values;
  std::sort(sorted.begin(), sorted.end());
  return detail::quantile_of_sorted(sorted, probability);
}

VERNIER_IMPL double detail::quantile_of_sorted(const ConstVectorRef& values, double probability) {
  const double at = probability * static_cast<double>(values.size() - 1);
  const auto below = static_cast<Index>(at);
  const double low = values(below), high = values(std::min(below + 1, values.size() - 1));
  const double share = at - static_cast<double>(below);
  return share == 0 || low == high ? low : low + share * (high - low);  // no difference of infinite values
}

}  // namespace vernier
