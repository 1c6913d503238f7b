#pragma once

#include <cmath>

#include "vernier/regression/detail/common_scaling.hpp"

namespace vernier::detail {

VERNIER_IMPL CommonScaling::CommonScaling(const ConstMatrixRef& targets, const VectorX* weights) {
  const double total = weights == nullptr ? static_cast<double>(targets.rows()) : weights->sum();
  const auto mean_of = [&](const ConstMatrixRef& rows) -> VectorX {
    // one way of adding up, so that weights of one give the same bits as none
    const MatrixX weighted = weights == nullptr ? MatrixX(rows) : MatrixX(weights->asDiagonal() * rows);
    return weighted.colwise().sum().transpose() / total;
  };
  mean = mean_of(targets);
  spread = std::sqrt(mean_of((targets.rowwise() - mean.transpose()).rowwise().squaredNorm())(0));
  if (!(spread > 1e-12 * targets.cwiseAbs().maxCoeff())) spread = 1;
}

VERNIER_IMPL MatrixX CommonScaling::apply(const ConstMatrixRef& targets) const {
  return (targets.rowwise() - mean.transpose()) / spread;
}

}  // namespace vernier::detail
