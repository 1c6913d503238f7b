// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/least_squares/prior_choice.hpp"

namespace vernier {

namespace detail {

/// Standard error of the mean of some values.
VERNIER_LOCAL double standard_error(const VectorX& values) {
  const double n = static_cast<double>(values.size()), mean = values.mean();
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (std::max)(1.0, n * (n - 1)));
}

}  // namespace detail

VERNIER_IMPL std::size_t one_standard_error_rule(const std::vector<PriorTrial>& trials) {
  demand(!trials.empty(), "one_standard_error_rule: no trials");
  const auto best = std::min_element(trials.begin(), trials.end(), [](const PriorTrial& a, const PriorTrial& b) {
    return a.errors.mean() < b.errors.mean();
  });
  for (std::size_t k = trials.size(); k-- > 0;) {
    const VectorX excess = trials[k].errors - best->errors;
    if (excess.mean() <= detail::standard_error(excess)) return k;
  }
  return trials.size() - 1;  // errors that are not finite compare with nothing
}

VERNIER_IMPL bool predicts_worse(const VectorX& with, const VectorX& without) {
  const VectorX excess = with - without;
  return !(excess.mean() <= detail::standard_error(excess));
}

}  // namespace vernier
