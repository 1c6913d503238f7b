#pragma once

/// @file
/// Affine scaling of columns, fitted on training samples.

#include <algorithm>
#include <cmath>

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
  VectorX factor;  ///< multiplies what is left

  /// Offsets and factors of columns of samples.
  static ColumnScaling fit(const Eigen::Ref<const MatrixX>& columns, Scaling kind) {
    const Index n = columns.rows(), d = columns.cols();
    ColumnScaling s{VectorX::Zero(d), VectorX::Ones(d)};
    if (kind == Scaling::none || n == 0) return s;
    for (Index j = 0; j < d; ++j) {
      const double low = columns.col(j).minCoeff(), high = columns.col(j).maxCoeff();
      double width = (high - low) / 2;
      s.offset(j) = low + width;
      if (kind == Scaling::standard) {
        s.offset(j) = columns.col(j).mean();
        width = std::sqrt((columns.col(j).array() - s.offset(j)).square().mean());
      }
      // differences at the level of rounding are no signal
      if (width > 1e-12 * std::max(std::abs(low), std::abs(high))) s.factor(j) = 1 / width;
    }
    return s;
  }

  /// Scaled columns.
  MatrixX apply(const Eigen::Ref<const MatrixX>& columns) const {
    return (columns.rowwise() - offset.transpose()) * factor.asDiagonal();
  }
};

}  // namespace vernier
