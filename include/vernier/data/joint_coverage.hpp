#pragma once

/// @file
/// Where the joints were when the arm was measured, and so how far what was learned from it may be trusted.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// The measured ranges of each joint, as a gate: 1 where every joint lies within one of its ranges, falling smoothly
/// (cubic) to 0 where one joint is `margin` away from all of its own. A joint without ranges is not looked at.
template <int N>
struct JointCoverage {
  /// A closed range of joint values [rad, m].
  struct Range {
    double lower;  ///< least
    double upper;  ///< greatest

    /// Equal at both ends.
    bool operator==(const Range&) const = default;
  };

  std::array<std::vector<Range>, N> ranges{};           ///< ascending, more than two margins apart
  JointVector<N> margin = JointVector<N>::Constant(1);  ///< width of the fall [rad, m], > 0

  /// The ranges of n measured joints. The margin is a tenth of a joint's whole range, at least 0.02; values closer than
  /// two margins belong to one range; every range is widened by 3/n of the whole (the extremes of n random values fall
  /// short by 1/n on average), at most half a margin, and what then comes closer than two margins is one range too.
  static JointCoverage covering(const JointRows<N>& joints) {
    JointCoverage coverage;
    if (joints.rows() == 0) return coverage;
    for (int i = 0; i < N; ++i) {
      std::vector<double> values(joints.col(i).begin(), joints.col(i).end());
      std::sort(values.begin(), values.end());
      const double whole = values.back() - values.front(), margin = std::max(0.02, 0.1 * whole);
      auto& ranges = coverage.ranges[static_cast<std::size_t>(i)];
      const double wider = std::min(3 * whole / static_cast<double>(values.size()), 0.5 * margin);
      for (const double value : values) {
        if (ranges.empty() || value - wider - ranges.back().upper > 2 * margin)
          ranges.push_back({value - wider, value + wider});
        ranges.back().upper = value + wider;
      }
      coverage.margin(i) = margin;
    }
    return coverage;
  }

  /// The factor at q; no allocation.
  double operator()(const JointVector<N>& q) const noexcept {
    double product = 1;
    for (int i = 0; i < N; ++i) product *= factor(i, q(i)).value;
    return product;
  }

  /// Its derivative with respect to q.
  Eigen::Matrix<double, 1, N> derivative(const JointVector<N>& q) const noexcept {
    Eigen::Matrix<double, 1, N> out;
    for (int j = 0; j < N; ++j) {
      out(j) = factor(j, q(j)).slope;
      for (int i = 0; i < N && out(j) != 0; ++i)
        if (i != j) out(j) *= factor(i, q(i)).value;
    }
    return out;
  }

 private:
  struct Factor {
    double value, slope;
  };

  Factor factor(int i, double q) const noexcept {
    const auto& own = ranges[static_cast<std::size_t>(i)];
    if (own.empty()) return {1, 0};
    double nearest = std::numeric_limits<double>::infinity();  // signed distance: above 0 beyond an upper end
    for (const Range& range : own) {
      const double beyond = q > range.upper ? q - range.upper : std::min(0.0, q - range.lower);
      if (!(std::abs(beyond) >= std::abs(nearest))) nearest = beyond;
    }
    const double outside = std::abs(nearest) / margin(i);
    if (outside <= 0) return {1, 0};
    if (!(outside < 1)) return {0, 0};
    return {1 - outside * outside * (3 - 2 * outside),
            -6 * outside * (1 - outside) * (nearest > 0 ? 1 : -1) / margin(i)};
  }
};

}  // namespace vernier
