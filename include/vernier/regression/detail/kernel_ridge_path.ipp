#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"

namespace vernier::detail {

VERNIER_IMPL KernelRidgePath::KernelRidgePath(MatrixX k, const ConstMatrixRef& targets, const VectorX& weights)
    : root_(weights.cwiseSqrt()), targets_(targets) {
  for (Index c = 0; c < k.cols(); ++c)
    for (Index r = c; r < k.rows(); ++r) k(r, c) *= root_(r) * root_(c);
  SymmetricEigen eigen = symmetric_eigen(k);
  vectors_ = std::move(eigen.vectors);
  squares_ = vectors_.cwiseAbs2();
  values_ = std::move(eigen.values);
  for (double& value : values_) value = std::max(value, 0.0);  // below: rounding
  MatrixX right(root_.size(), 1 + targets_.cols());
  right.col(0) = root_;
  right.rightCols(targets_.cols()) = rows_scaled(root_, targets_);
  projected_ = transposed_matrix_product(vectors_, right);
}

VERNIER_IMPL MatrixX KernelRidgePath::leave_one_out_residuals(double lambda) const {
  const VectorX weights = root_.cwiseAbs2();
  const Index n = weights.size();
  VectorX factor(n);
  if (!std::isfinite(lambda)) {
    const double total = weights.sum();
    for (Index i = 0; i < n; ++i) factor(i) = 1 / (1 - weights(i) / total);
    return rows_scaled(factor, rows_minus(targets_, transposed_product(targets_, weights) / total));
  }
  const VectorX of_ones = projected_.col(0);
  VectorX shares(n);
  for (Index d = 0; d < n; ++d) shares(d) = 1 / (values_(d) + lambda);
  const VectorX ones = shares.cwiseProduct(of_ones);
  const double precision = ones.dot(of_ones);
  const MatrixX targets = projected_.rightCols(targets_.cols());
  const VectorX mean = transposed_product(targets, ones) / precision;
  MatrixX alpha = rows_scaled(shares, targets);
  add_product(alpha, ones, mean.transpose(), -1);
  // of (K + lambda / W)^-1 with the mean projected out
  const VectorX diagonal = product(squares_, shares), along = product(vectors_, ones);
  for (Index i = 0; i < n; ++i) factor(i) = root_(i) / (weights(i) * (diagonal(i) - along(i) * along(i) / precision));
  return rows_scaled(factor, matrix_product(vectors_, alpha));
}

VERNIER_IMPL double KernelRidgePath::leave_one_out_error(double lambda) const {
  return rows_scaled(root_, leave_one_out_residuals(lambda)).squaredNorm() / root_.squaredNorm();
}

}  // namespace vernier::detail
