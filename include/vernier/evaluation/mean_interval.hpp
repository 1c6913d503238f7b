// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The mean of some errors with its confidence interval.

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
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/mean_interval.ipp"
#endif
