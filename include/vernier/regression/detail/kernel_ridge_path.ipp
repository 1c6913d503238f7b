// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/regression/detail/kernel_ridge_path.hpp"

namespace vernier::detail {

/// T + lambda = L D L' for a tridiagonal T of no negative eigenvalue.
class ShiftedTridiagonal {
 public:
  VERNIER_LOCAL ShiftedTridiagonal(const TridiagonalForm& form, double lambda)
      : pivots_(form.diagonal.size()), multipliers_(form.subdiagonal.size()) {
    // no pivot is below the smallest eigenvalue, but for rounding
    pivots_(0) = (std::max)(VERNIER_LATER(form).diagonal(0) + lambda, lambda);
    for (Index k = 1; k < pivots_.size(); ++k) {
      multipliers_(k - 1) = form.subdiagonal(k - 1) / pivots_(k - 1);
      pivots_(k) =
          (std::max)(VERNIER_LATER(form).diagonal(k) + lambda - multipliers_(k - 1) * form.subdiagonal(k - 1), lambda);
    }
  }

  /// (T + lambda)^-1 x, in place.
  VERNIER_LOCAL void solve(MatrixX& x) const {
    const Index n = pivots_.size();
    for (Index c = 0; c < x.cols(); ++c) {
      for (Index k = 1; k < n; ++k) x(k, c) -= multipliers_(k - 1) * x(k - 1, c);
      for (Index k = 0; k < n; ++k) x(k, c) /= pivots_(k);
      for (Index k = n - 1; k > 0; --k) x(k - 1, c) -= multipliers_(k - 1) * x(k, c);
    }
  }

  /// Diagonal of Q (T + lambda)^-1 Q'.
  VERNIER_LOCAL VectorX inverse_diagonal(const MatrixX& q) const {
    VERNIER_LATER_TYPE(VectorX)
    row = VERNIER_LATER(q).col(0),
    sum = VERNIER_LATER(row).cwiseAbs2() / pivots_(0);  // rows of L^-1 Q'
    for (Index k = 1; k < pivots_.size(); ++k) {
      row = VERNIER_LATER(q).col(k) - multipliers_(k - 1) * row;
      sum += VERNIER_LATER(row).cwiseAbs2() / pivots_(k);
    }
    return sum;
  }

 private:
  VectorX pivots_, multipliers_;
};

VERNIER_IMPL KernelRidgePath::KernelRidgePath(MatrixX k, const ConstMatrixRef& targets, const VectorX& weights)
    : root_(VERNIER_LATER(weights).cwiseSqrt()), targets_(targets) {
  for (Index c = 0; c < k.cols(); ++c)
    for (Index r = c; r < k.rows(); ++r) k(r, c) *= root_(r) * root_(c);
  form_ = tridiagonal_form(k);
  MatrixX right(root_.size(), 1 + targets_.cols());
  VERNIER_LATER(right).col(0) = root_;
  VERNIER_LATER(right).rightCols(targets_.cols()) = rows_scaled(root_, targets_);
  projected_ = transposed_matrix_product(form_.basis, right);
}

VERNIER_IMPL MatrixX KernelRidgePath::leave_one_out_residuals(double lambda) const {
  const auto& targets = VERNIER_LATER(targets_);
  const VectorX weights = VERNIER_LATER(root_).cwiseAbs2();
  const Index n = weights.size();
  VectorX factor(n);
  if (!std::isfinite(lambda)) {
    const double total = weights.sum();
    for (Index i = 0; i < n; ++i) factor(i) = 1 / (1 - weights(i) / total);
    return rows_scaled(factor, rows_minus(targets, transposed_product(targets, weights) / total));
  }
  const ShiftedTridiagonal shifted(form_, lambda);
  MatrixX alpha = projected_;
  shifted.solve(alpha);
  const VectorX ones = VERNIER_LATER(alpha).col(0);
  const double precision = VERNIER_LATER(ones).dot(VERNIER_LATER(projected_).col(0));
  const VERNIER_LATER_TYPE(VectorX) mean =
      transposed_product(VERNIER_LATER(projected_).rightCols(targets.cols()), ones) / precision;
  alpha = VERNIER_LATER(alpha).rightCols(targets.cols()).eval();
  add_product(alpha, ones, VERNIER_LATER(mean).transpose(), -1);
  // of (K + lambda / W)^-1 with the mean projected out
  const VectorX diagonal = shifted.inverse_diagonal(form_.basis), along = product(form_.basis, ones);
  for (Index i = 0; i < n; ++i) factor(i) = root_(i) / (weights(i) * (diagonal(i) - along(i) * along(i) / precision));
  return rows_scaled(factor, matrix_product(form_.basis, alpha));
}

VERNIER_IMPL double KernelRidgePath::leave_one_out_error(double lambda) const {
  return rows_scaled(root_, leave_one_out_residuals(lambda)).squaredNorm() / root_.squaredNorm();
}

}  // namespace vernier::detail
