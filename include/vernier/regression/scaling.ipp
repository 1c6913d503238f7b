#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/regression/scaling.hpp"

namespace vernier {

VERNIER_IMPL ColumnScaling ColumnScaling::fit(const ConstMatrixRef& columns, Scaling kind) {
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

VERNIER_IMPL MatrixX ColumnScaling::apply(const ConstMatrixRef& columns) const {
  return (columns.rowwise() - offset.transpose()) * factor.asDiagonal();
}

}  // namespace vernier
