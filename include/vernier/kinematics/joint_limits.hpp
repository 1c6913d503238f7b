#pragma once

/// @file
/// Ranges of joint values.

#include <limits>

#include "vernier/core/types.hpp"

namespace vernier {

/// A box of joint values [rad, m]; unbounded by default.
template <int N>
struct JointLimits {
  JointVector<N> lower = JointVector<N>::Constant(-std::numeric_limits<double>::infinity());
  JointVector<N> upper = JointVector<N>::Constant(std::numeric_limits<double>::infinity());

  bool contains(const JointVector<N>& q) const noexcept {
    return (q.array() >= lower.array()).all() && (q.array() <= upper.array()).all();
  }
  JointVector<N> clamp(const JointVector<N>& q) const noexcept { return q.cwiseMax(lower).cwiseMin(upper); }
};

}  // namespace vernier
