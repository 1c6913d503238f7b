// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/concepts.hpp"
#include "vernier/regression/detail/common_scaling.hpp"

namespace vernier::detail {

VERNIER_IMPL CommonScaling::CommonScaling(const ConstMatrixRef& targets, const VectorX* weights) {
  // one way of adding up, so that weights of one give the same bits as none
  const VectorX each = weights_or_ones(weights, targets.rows());
  const double total = each.sum();
  mean = transposed_product(targets, each) / total;
  spread = std::sqrt(each.dot(squared_row_norms(rows_minus(targets, mean))) / total);
  if (!(spread > 1e-12 * (std::max)(VERNIER_LATER(targets).maxCoeff(), -VERNIER_LATER(targets).minCoeff()))) spread = 1;
}

VERNIER_IMPL MatrixX CommonScaling::apply(const ConstMatrixRef& targets) const {
  return rows_minus(targets, mean) / spread;
}

}  // namespace vernier::detail
