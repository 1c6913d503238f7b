// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/kernel_system.hpp"

namespace vernier::detail {

VERNIER_IMPL KernelFeatures::KernelFeatures(const ConstMatrixRef& inputs, InputMap map, Scaling input_scaling)
    : input_map(map) {
  const HiddenLayer layer{.nodes = 1, .input_map = map, .input_scaling = input_scaling};
  const MatrixX mapped = layer.map(inputs);
  scaling = layer.scaling(mapped);
  values = scaling.apply(mapped);
}

VERNIER_IMPL void KernelFeatures::divide(const VectorX& length_scales) {
  for (Index j = 0; j < values.cols(); ++j) {
    const double length = length_scales(j % length_scales.size());
    scaling.factor(j) /= length;
    VERNIER_LATER(values).col(j) /= length;
  }
}

VERNIER_IMPL KernelSystem::KernelSystem(MatrixX a, const VectorX& noise, const ConstMatrixRef& targets)
    : factor(std::move(a)) {
  for (Index i = 0; i < noise.size(); ++i) factor(i, i) += noise(i);
  solved = cholesky(factor);
  if (!solved) return;
  const Index n = factor.rows();
  const Index m = targets.cols();
  const VectorX centre = column_means(targets);  // first, so that little cancels later
  MatrixX right(n, 1 + m);
  VERNIER_LATER(right).col(0).setOnes();
  VERNIER_LATER(right).rightCols(m) = rows_minus(targets, centre);
  MatrixX solution = right;
  solve_cholesky(factor, solution);
  ones = VERNIER_LATER(solution).col(0);
  precision = ones.sum();
  alpha = VERNIER_LATER(solution).rightCols(m);
  mean.resize(m);
  square.resize(m);
  for (Index o = 0; o < m; ++o) {
    const double shift = VERNIER_LATER(alpha).col(o).sum() / precision;
    VERNIER_LATER(alpha).col(o) -= shift * ones;
    square(o) = VERNIER_LATER(right).col(1 + o).dot(VERNIER_LATER(alpha).col(o));
    mean(o) = centre(o) + shift;
  }
}

VERNIER_IMPL double KernelSystem::log_determinant() const { return cholesky_log_determinant(factor); }

}  // namespace vernier::detail
