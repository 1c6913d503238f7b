// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/evaluation/mean_interval.hpp"

namespace vernier {

VERNIER_IMPL MeanInterval MeanInterval::of(const ConstVectorRef& errors) {
  const Index n = errors.size();
  demand(n > 0, "MeanInterval: no errors");
  const double mean = errors.mean();
  if (n < 5) return {mean, 0, std::numeric_limits<double>::infinity()};
  // the quantile of Student's t at 0.975, expanded about that of the normal distribution
  const double z = 1.9599639845400545, v = static_cast<double>(n - 1), z2 = z * z;
  const double t = z * (1 + (z2 + 1) / (4 * v) + ((5 * z2 + 16) * z2 + 3) / (96 * v * v) +
                        (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * v * v * v) +
                        ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / (92160 * v * v * v * v));
  double squares = 0;
  for (const double error : errors) squares += (error - mean) * (error - mean);
  const double half = t * std::sqrt(squares / v / static_cast<double>(n));
  return {mean, (std::max)(0.0, mean - half), mean + half};
}

VERNIER_IMPL MeanInterval MeanInterval::of(const ConstVectorRef& errors, std::span<const Index> groups) {
  if (groups.empty()) return of(errors);
  demand(static_cast<Index>(groups.size()) == errors.size(), "MeanInterval: ", groups.size(), " groups for ",
         errors.size(), " errors");
  VectorX sums = VectorX::Zero(*std::max_element(groups.begin(), groups.end()) + 1), counts = sums;
  for (Index i = 0; i < errors.size(); ++i) {
    const Index group = groups[static_cast<std::size_t>(i)];
    sums(group) += errors(i);
    counts(group) += 1;
  }
  for (Index k = 0; k < sums.size(); ++k) sums(k) /= counts(k);
  return of(sums);
}

}  // namespace vernier
