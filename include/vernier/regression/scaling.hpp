// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Affine scaling of columns, fitted on training samples.

#include "vernier/core/types.hpp"

namespace vernier {

/// How columns are scaled before learning.
enum class Scaling {
  none,      ///< as they are
  min_max,   ///< to [-1, 1] over the samples
  standard,  ///< to zero mean and unit standard deviation over the samples
};

/// `scaled = (x - offset) * factor`, column by column. A constant column is shifted to zero and not stretched.
struct ColumnScaling {
  VectorX offset;  ///< subtracted first
  VectorX factor;  ///< multiplies the difference

  /// Offsets and factors of columns of samples.
  VERNIER_API static ColumnScaling fit(const ConstMatrixRef& columns, Scaling kind);

  /// Scaled columns.
  VERNIER_API MatrixX apply(const ConstMatrixRef& columns) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/scaling.ipp"
#endif
