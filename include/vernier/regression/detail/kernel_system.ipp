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
    values.col(j) /= length;
  }
}

VERNIER_IMPL KernelSystem::KernelSystem(MatrixX a, const VectorX& noise, const ConstMatrixRef& targets)
    : factor(std::move(a)) {
  factor.diagonal() += noise;
  solved = cholesky(factor);
  if (!solved) return;
  const Index n = factor.rows();
  const Index m = targets.cols();
  const Eigen::RowVectorXd centre = targets.colwise().mean();  // first, so that little cancels later
  MatrixX right(n, 1 + m);
  right << VectorX::Ones(n), targets.rowwise() - centre;
  MatrixX solution = right;
  solve_cholesky(factor, solution);
  ones = solution.col(0);
  precision = ones.sum();
  mean = solution.rightCols(m).colwise().sum().transpose() / precision;
  alpha = solution.rightCols(m) - ones * mean.transpose();
  square = right.rightCols(m).cwiseProduct(alpha).colwise().sum().transpose();
  mean += centre.transpose();
}

VERNIER_IMPL double KernelSystem::log_determinant() const { return 2 * factor.diagonal().array().log().sum(); }

}  // namespace vernier::detail
