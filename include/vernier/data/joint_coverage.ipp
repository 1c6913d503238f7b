// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/joint_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace vernier::detail {

VERNIER_IMPL CoveredRanges covered_ranges(const ConstVectorRef& values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double total = sorted.back() - sorted.front();
  CoveredRanges out{{}, {}, (std::max)(0.02, 0.1 * total)};
  const double wider = (std::min)(3 * total / static_cast<double>(sorted.size()), 0.5 * out.margin);
  for (const double value : sorted) {
    if (out.widened.empty() || value - wider - out.widened.back().upper > 2 * out.margin) {
      out.widened.push_back({value - wider, value + wider});
      out.measured.push_back({value, value});
    }
    out.widened.back().upper = value + wider;
    out.measured.back().upper = value;
  }
  return out;
}

VERNIER_IMPL std::vector<JointRange> joined_ranges(std::vector<JointRange> ranges,
                                                   const std::vector<JointRange>& others, double margin) {
  ranges.insert(ranges.end(), others.begin(), others.end());
  std::sort(ranges.begin(), ranges.end(), [](const JointRange& a, const JointRange& b) { return a.lower < b.lower; });
  std::vector<JointRange> out;
  for (const JointRange& range : ranges)
    if (out.empty() || range.lower - out.back().upper > 2 * margin)
      out.push_back(range);
    else
      out.back().upper = (std::max)(out.back().upper, range.upper);
  return out;
}

VERNIER_IMPL GateFactor gate_factor(const std::vector<JointRange>& ranges, double margin, bool periodic,
                                    double q) noexcept {
  if (ranges.empty()) return {1, 0};
  constexpr double turn = 2 * std::numbers::pi, infinity = std::numeric_limits<double>::infinity();
  double above = infinity, below = infinity;  // distances to the nearest range on either side
  for (const JointRange& range : ranges) {
    // the distance up from the lower end, on the circle that within a turn
    const double length = range.upper - range.lower, from_lower = q - range.lower;
    const double turned = periodic ? from_lower - turn * std::floor(from_lower / turn) : from_lower;
    if (turned >= 0 && turned <= length) return {1, 0};
    if (turned > length) below = (std::min)(below, turned - length);
    if (periodic || turned < 0) above = (std::min)(above, periodic ? turn - turned : -turned);
  }
  if (above + below <= 2 * margin) return {1, 0};
  const double outside = (std::min)(above, below) / margin;
  if (!(outside < 1)) return {0, 0};
  return {1 - outside * outside * (3 - 2 * outside), 6 * outside * (1 - outside) * (above < below ? 1 : -1) / margin};
}

}  // namespace vernier::detail
