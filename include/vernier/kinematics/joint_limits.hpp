// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Ranges of joint values.

#include <algorithm>
#include <limits>

#include "vernier/core/checked_joints.hpp"
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
    bool out = true;
    for (int j = 0; j < N; ++j) out = out && q(j) >= lower(j) && q(j) <= upper(j);
    return out;
  }
  /// Whether joint values whose number is known at run time only lie within, bounds included.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  bool contains(const Q& q) const {
    return contains(detail::joint_vector<N>(q));
  }
  /// The nearest joints within.
  JointVector<N> clamp(const JointVector<N>& q) const noexcept {
    JointVector<N> out;
    for (int j = 0; j < N; ++j) out(j) = (std::min)((std::max)(q(j), lower(j)), upper(j));
    return out;
  }
  /// The nearest joints within to joint values whose number is known at run time only.
  /// @throws std::invalid_argument on another number of joint values
  template <SizedAtRunTime Q>
  JointVector<N> clamp(const Q& q) const {
    return clamp(detail::joint_vector<N>(q));
  }
};

}  // namespace vernier
