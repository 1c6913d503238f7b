#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "vernier/regression/detail/rank_nodes.hpp"

namespace vernier::detail {

VERNIER_IMPL RankedNodes rank_nodes(const ConstMatrixRef& h, const ConstMatrixRef& targets, const VectorX& weights) {
  constexpr double rounding = 1e-10;
  const Index n = h.rows();
  const VectorX root = weights.cwiseSqrt();
  MatrixX columns = root.asDiagonal() * h, residual = root.asDiagonal() * targets;
  VectorX basis = root / root.norm(), leverage = VectorX::Zero(n);
  const VectorX norms = columns.colwise().norm();
  MatrixX taken(n, std::min(n, h.cols() + 1));
  std::vector<Index> left(static_cast<std::size_t>(h.cols()));
  for (Index k = 0; k < h.cols(); ++k) left[static_cast<std::size_t>(k)] = k;

  RankedNodes out;
  for (Index count = 0;; ++count) {
    taken.col(count) = basis;
    leverage += basis.cwiseAbs2();
    residual -= basis * (basis.transpose() * residual);
    const Eigen::ArrayXd kept = 1 - leverage.array();
    out.press.push_back(kept.minCoeff() > 1e-8
                            ? (kept.inverse().matrix().asDiagonal() * residual).squaredNorm() / weights.sum()
                            : std::numeric_limits<double>::infinity());
    if (count + 1 == taken.cols()) break;

    std::size_t best = left.size();
    double most = -1;
    for (std::size_t i = 0; i < left.size(); ++i) {
      auto column = columns.col(left[i]);
      column -= basis * basis.dot(column);
      const double square = column.squaredNorm();
      if (!(square > std::pow(rounding * norms(left[i]), 2))) continue;
      const double gain = (column.transpose() * residual).squaredNorm() / square;
      if (gain > most) {
        most = gain;
        best = i;
      }
    }
    if (best == left.size()) break;
    const Index node = left[best];
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    basis = columns.col(node);
    for (int pass = 0; pass < 2; ++pass)  // what many subtractions have left of the directions taken
      basis -= taken.leftCols(count + 1) * (taken.leftCols(count + 1).transpose() * basis);
    if (!(basis.norm() > rounding * norms(node))) break;
    basis.normalize();
    out.order.push_back(node);
  }
  return out;
}

}  // namespace vernier::detail
