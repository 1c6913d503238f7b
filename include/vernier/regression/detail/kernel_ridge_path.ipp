#pragma once

#include <cmath>
#include <utility>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"

namespace vernier::detail {

VERNIER_IMPL KernelRidgePath::KernelRidgePath(MatrixX k, const ConstMatrixRef& targets, const VectorX& weights)
    : root_(weights.cwiseSqrt()), targets_(targets) {
  k = root_.asDiagonal() * k * root_.asDiagonal();
  SymmetricEigen eigen = symmetric_eigen(k);
  vectors_ = std::move(eigen.vectors);
  values_ = eigen.values.cwiseMax(0.0);  // below: rounding
  MatrixX right(root_.size(), 1 + targets_.cols());
  right << root_, root_.asDiagonal() * targets_;
  projected_ = vectors_.transpose() * right;
}

VERNIER_IMPL MatrixX KernelRidgePath::leave_one_out_residuals(double lambda) const {
  const VectorX weights = root_.cwiseAbs2();
  if (!std::isfinite(lambda)) {
    const double total = weights.sum();
    const Eigen::RowVectorXd mean = weights.transpose() * targets_ / total;
    return (1 - weights.array() / total).inverse().matrix().asDiagonal() * (targets_.rowwise() - mean);
  }
  const VectorX shares = (values_.array() + lambda).inverse().matrix();
  const VectorX ones = shares.cwiseProduct(projected_.col(0));
  const double precision = ones.dot(projected_.col(0));
  const auto targets = projected_.rightCols(targets_.cols());
  const Eigen::RowVectorXd mean = ones.transpose() * targets / precision;
  const MatrixX alpha = root_.asDiagonal() * (vectors_ * (shares.asDiagonal() * targets - ones * mean));
  // of (K + lambda / W)^-1 with the mean projected out
  const VectorX diagonal =
      weights.cwiseProduct(vectors_.cwiseAbs2() * shares - (vectors_ * ones).cwiseAbs2() / precision);
  return diagonal.cwiseInverse().asDiagonal() * alpha;
}

VERNIER_IMPL double KernelRidgePath::leave_one_out_error(double lambda) const {
  return (root_.asDiagonal() * leave_one_out_residuals(lambda)).squaredNorm() / root_.squaredNorm();
}

}  // namespace vernier::detail
