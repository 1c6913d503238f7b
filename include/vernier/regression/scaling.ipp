// SPDX-License-Identifier: BSD-3-Clause
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
    const double low = VERNIER_LATER(columns).col(j).minCoeff(), high = VERNIER_LATER(columns).col(j).maxCoeff();
    double width = (high - low) / 2;
    s.offset(j) = low + width;
    if (kind == Scaling::standard) {
      s.offset(j) = VERNIER_LATER(columns).col(j).mean();
      double sum = 0;
      for (Index i = 0; i < n; ++i) sum += std::pow(columns(i, j) - s.offset(j), 2);
      width = std::sqrt(sum / static_cast<double>(n));
    }
    // differences at the level of rounding are no signal
    if (width > 1e-12 * (std::max)(std::abs(low), std::abs(high))) s.factor(j) = 1 / width;
  }
  return s;
}

VERNIER_IMPL MatrixX ColumnScaling::apply(const ConstMatrixRef& columns) const {
  MatrixX out(columns.rows(), columns.cols());
  for (Index j = 0; j < out.cols(); ++j)
    for (Index i = 0; i < out.rows(); ++i) out(i, j) = (columns(i, j) - offset(j)) * factor(j);
  return out;
}

}  // namespace vernier
