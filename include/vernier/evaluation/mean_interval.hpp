// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The mean of some errors with its confidence interval.

#include <span>

#include "vernier/core/types.hpp"

namespace vernier {

/// Mean of n errors, with the 95 % interval of their expectation by Student's t: `mean +- t s / sqrt(n)`. Errors are
/// taken to be independent and not negative. With fewer than 5 the interval is infinite.
struct MeanInterval {
  double mean = 0;   ///< of the errors, in their unit
  double lower = 0;  ///< not below 0
  double upper = 0;  ///< likewise

  /// @throws std::invalid_argument without errors
  VERNIER_API static MeanInterval of(const ConstVectorRef& errors);
  /// Of the means of some groups: errors of one group, such as readings of one pose, depend on each other.
  /// @param errors of all rows
  /// @param groups the group of each error, from 0; none: each error is one
  /// @throws std::invalid_argument without errors, or for another number of groups
  VERNIER_API static MeanInterval of(const ConstVectorRef& errors, std::span<const Index> groups);
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/mean_interval.ipp"
#endif
