// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Scaling of targets by one factor for all columns.

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Targets less their mean, all columns divided by their common spread, so that outputs weigh as they are.
struct CommonScaling {
  VectorX mean;   ///< of each column
  double spread;  ///< root of the mean squared distance from the mean; 1 where that is rounding

  /// Of n x m targets with n weights; null: all the same.
  VERNIER_API explicit CommonScaling(const ConstMatrixRef& targets, const VectorX* weights = nullptr);

  /// Scaled targets.
  VERNIER_API MatrixX apply(const ConstMatrixRef& targets) const;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/common_scaling.ipp"
#endif
