#pragma once

#include "vernier/data/joint_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::detail {

VERNIER_IMPL std::vector<JointRange> covered_ranges(const ConstVectorRef& values, double& margin) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double total = sorted.back() - sorted.front();
  margin = std::max(0.02, 0.1 * total);
  const double wider = std::min(3 * total / static_cast<double>(sorted.size()), 0.5 * margin);
  std::vector<JointRange> ranges;
  for (const double value : sorted) {
    if (ranges.empty() || value - wider - ranges.back().upper > 2 * margin)
      ranges.push_back({value - wider, value + wider});
    ranges.back().upper = value + wider;
  }
  return ranges;
}

VERNIER_IMPL GateFactor gate_factor(const std::vector<JointRange>& ranges, double margin, double q) noexcept {
  if (ranges.empty()) return {1, 0};
  double nearest = std::numeric_limits<double>::infinity();  // signed distance: positive above an upper end
  for (const JointRange& range : ranges) {
    const double beyond = q > range.upper ? q - range.upper : std::min(0.0, q - range.lower);
    if (!(std::abs(beyond) >= std::abs(nearest))) nearest = beyond;
  }
  const double outside = std::abs(nearest) / margin;
  if (outside <= 0) return {1, 0};
  if (!(outside < 1)) return {0, 0};
  return {1 - outside * outside * (3 - 2 * outside), -6 * outside * (1 - outside) * (nearest > 0 ? 1 : -1) / margin};
}

}  // namespace vernier::detail
