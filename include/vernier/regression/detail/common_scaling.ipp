#pragma once

#include <cmath>

#include "vernier/regression/detail/common_scaling.hpp"

namespace vernier::detail {

VERNIER_IMPL CommonScaling::CommonScaling(const ConstMatrixRef& targets, const VectorX* weights) {
  const auto mean_of = [&](const ConstMatrixRef& rows) -> VectorX {
    if (weights == nullptr) return rows.colwise().mean().transpose();
    return rows.transpose() * *weights / weights->sum();
  };
  mean = mean_of(targets);
  spread = std::sqrt(mean_of((targets.rowwise() - mean.transpose()).rowwise().squaredNorm())(0));
  if (!(spread > 1e-12 * targets.cwiseAbs().maxCoeff())) spread = 1;
}

VERNIER_IMPL MatrixX CommonScaling::apply(const ConstMatrixRef& targets) const {
  return (targets.rowwise() - mean.transpose()) / spread;
}

}  // namespace vernier::detail
