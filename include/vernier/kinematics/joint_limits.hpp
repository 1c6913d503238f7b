#pragma once

/// @file
/// Ranges of joint values.

#include <limits>

#include "vernier/core/types.hpp"

namespace vernier {

/// A box of joint values [rad, m]; unbounded by default.
template <int N>
struct JointLimits {
  /// Lower bounds.
  JointVector<N> lower = JointVector<N>::Constant(-std::numeric_limits<double>::infinity());
  /// Upper bounds.
  JointVector<N> upper = JointVector<N>::Constant(std::numeric_limits<double>::infinity());

  /// Whether q lies within, bounds included.
  bool contains(const JointVector<N>& q) const noexcept {
    return (q.array() >= lower.array()).all() && (q.array() <= upper.array()).all();
  }
  /// The nearest joints within.
  JointVector<N> clamp(const JointVector<N>& q) const noexcept { return q.cwiseMax(lower).cwiseMin(upper); }
};

}  // namespace vernier
