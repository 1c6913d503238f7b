// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier {

VERNIER_IMPL double robust_weight(Loss loss, double norm, double threshold) {
  const double ratio = norm / threshold;
  switch (loss) {
    case Loss::squared: return 1;
    case Loss::huber: return (std::min)(1.0, 1 / ratio);
    case Loss::cauchy: return 1 / (1 + ratio * ratio);
  }
  return 1;
}

VERNIER_IMPL double robust_sigma(std::vector<double> norms, int dimension) {
  demand(dimension == 1 || dimension == 3, "robust_sigma: dimension is ", dimension, ", must be 1 or 3");
  if (norms.empty()) return 0;
  const auto middle = norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2);
  std::nth_element(norms.begin(), middle, norms.end());
  constexpr double median_size = 0.6745;  // of a standard normal number
  return *middle / (dimension == 1 ? median_size : median_norm);
}

VERNIER_IMPL double robust_threshold(std::vector<double> norms, int dimension) {
  const double sigma = robust_sigma(std::move(norms), dimension);
  return (dimension == 1 ? 1.345 : 2.8) * sigma;
}

}  // namespace vernier
