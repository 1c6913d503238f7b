// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/rank_nodes.hpp"

namespace vernier::detail {

VERNIER_IMPL RankedNodes rank_nodes(const ConstMatrixRef& h, const ConstMatrixRef& targets, const VectorX& weights) {
  constexpr double rounding = 1e-10;
  const Index n = h.rows();
  const VectorX root = VERNIER_LATER(weights).cwiseSqrt();
  MatrixX columns = rows_scaled(root, h), residual = rows_scaled(root, targets);
  VectorX basis = root / root.norm(), leverage = VectorX::Zero(n), inverse(n);
  const VectorX norms = VERNIER_LATER(squared_column_norms(columns)).cwiseSqrt();
  MatrixX taken(n, (std::min)(n, h.cols() + 1));
  std::vector<Index> left(static_cast<std::size_t>(h.cols()));
  for (Index k = 0; k < h.cols(); ++k) left[static_cast<std::size_t>(k)] = k;

  RankedNodes out;
  for (Index count = 0;; ++count) {
    VERNIER_LATER(taken).col(count) = basis;
    leverage += VERNIER_LATER(basis).cwiseAbs2();
    for (Index o = 0; o < residual.cols(); ++o)
      VERNIER_LATER(residual).col(o) -= basis.dot(VERNIER_LATER(residual).col(o)) * basis;
    for (Index i = 0; i < n; ++i) inverse(i) = 1 / (1 - leverage(i));
    out.press.push_back(1 - VERNIER_LATER(leverage).maxCoeff() > 1e-8
                            ? rows_scaled(inverse, residual).squaredNorm() / weights.sum()
                            : std::numeric_limits<double>::infinity());
    if (count + 1 == taken.cols()) break;

    std::size_t best = left.size();
    double most = -1;
    for (std::size_t i = 0; i < left.size(); ++i) {
      auto column = VERNIER_LATER(columns).col(left[i]);
      column -= basis.dot(column) * basis;
      const double square = column.squaredNorm();
      if (!(square > std::pow(rounding * norms(left[i]), 2))) continue;
      double gain = 0;
      for (Index o = 0; o < residual.cols(); ++o)
        gain += std::pow(column.dot(VERNIER_LATER(residual).col(o)), 2) / square;
      if (gain > most) {
        most = gain;
        best = i;
      }
    }
    if (best == left.size()) break;
    const Index node = left[best];
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    basis = VERNIER_LATER(columns).col(node);
    const auto before = VERNIER_LATER(taken).leftCols(count + 1);
    for (int pass = 0; pass < 2; ++pass)  // what many subtractions have left of the directions taken
      basis -= product(before, transposed_product(before, basis));
    if (!(basis.norm() > rounding * norms(node))) break;
    basis.normalize();
    out.order.push_back(node);
  }
  return out;
}

}  // namespace vernier::detail
