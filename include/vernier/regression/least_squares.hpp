// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Linear least squares for output weights: minimum norm, ridge, and closed-form leave-one-out.

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Minimum-norm solution of `min |H beta - T|`: singular values below `rcond` times the largest count as zero.
/// @param h     n x nodes
/// @param t     n x outputs
/// @param rcond relative cut, in [0, 1)
/// @return      nodes x outputs
VERNIER_API MatrixX minimum_norm_solution(const ConstMatrixRef& h, const ConstMatrixRef& t, double rcond);

/// Value and solution of a regularised least-squares problem.
struct RidgeSolution {
  MatrixX beta;      ///< nodes x outputs
  double objective;  ///< `|H beta - T|^2 + lambda |beta|^2`
};

/// `min |H beta - T|^2 + lambda |beta|^2` with lambda = `relative_lambda` tr(H'H) / h, by normal equations. The ridge
/// bounds the condition of the Gram matrix by h / relative_lambda; where the factorisation fails all the same, QR of
/// the stacked system takes over. The objective is computed from the residual, so an error of beta enters it squared.
VERNIER_API RidgeSolution relative_ridge(const ConstMatrixRef& h, const ConstMatrixRef& t, double relative_lambda);

/// Output weights, nodes x outputs, of `min |H beta - T|^2 + lambda |beta|^2` from the products alone; empty where they
/// are too badly conditioned.
/// @param gram   H'H, its lower triangle
/// @param right  T'H, outputs x nodes
/// @param lambda absolute
VERNIER_API MatrixX ridge_weights(const ConstMatrixRef& gram, const ConstMatrixRef& right, double lambda);

/// `|H beta - T|^2 + lambda |beta|^2` from the products alone: no second pass over the samples, but digits are lost
/// where the fit is nearly perfect or beta is huge. Returns -1 where fewer than seven digits would be left.
/// @param gram          H'H, its lower triangle
/// @param right         T'H, outputs x nodes
/// @param target_square |T|^2
/// @param beta          nodes x outputs, or empty
/// @param lambda        absolute
/// @param trace         of H'H as summed up, before anything was subtracted from it
VERNIER_API double objective_from_products(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                           double target_square, const MatrixX& beta, double lambda, double trace);

/// The objective of `relative_ridge` from the products alone, see `objective_from_products`.
/// @param gram            H'H, its lower triangle
/// @param right           T'H, outputs x nodes
/// @param target_square   |T|^2
/// @param relative_lambda as in `relative_ridge`
VERNIER_API double relative_ridge_objective(const ConstMatrixRef& gram, const ConstMatrixRef& right,
                                            double target_square, double relative_lambda);

/// Ridge regression with an unpenalised mean, for every lambda from one decomposition. Samples may have weights, which
/// count relative to their mean.
/// @cite Allen 1974 (PRESS); Huang 2012
class RidgePath {
 public:
  /// @param h       n x nodes, centred here
  /// @param t       n x outputs, centred here
  /// @param weights of the samples, positive; null: all the same
  VERNIER_API RidgePath(const ConstMatrixRef& h, const ConstMatrixRef& t, const VectorX* weights = nullptr);

  /// Numerical rank of the centred hidden layer.
  VERNIER_API Index rank() const;

  /// Square of the largest singular value: the natural unit of lambda.
  VERNIER_API double scale() const;

  /// nodes x outputs at `lambda` > 0; infinity gives zero.
  VERNIER_API MatrixX beta(double lambda) const;

  /// The intercept of `H beta`: `mean(T) - mean(H) beta`.
  VERNIER_API VectorX offset(const MatrixX& beta) const;

  /// Residuals of leaving each sample out, n x outputs, at `lambda` > 0; infinity is the mean alone. Those of samples
  /// with weights are multiplied by the square root of the weight relative to the mean weight. With as many nodes
  /// as samples the residual and `1 - leverage` are sums over lambda / (s^2 + lambda), never differences that cancel.
  VERNIER_API MatrixX leave_one_out_residuals(double lambda) const;

 private:
  VERNIER_API MatrixX scaled(const ConstMatrixRef& rows, bool weighted) const;

  VectorX shares_;  // of the samples, sum 1
  VectorX mean_h_, mean_t_;
  MatrixX centred_t_;
  detail::ThinSvd svd_;
  MatrixX squares_;  // of the elements of U
  MatrixX projected_;
};

/// A ridge and its leave-one-out error.
struct LeaveOneOutChoice {
  double lambda;              ///< absolute; infinity: the mean alone
  double mean_squared_error;  ///< leave-one-out, per sample, summed over outputs
};

/// The lambda of least leave-one-out error over a grid of half decades relative to the problem's scale; infinity, the
/// mean alone, is a candidate.
VERNIER_API LeaveOneOutChoice choose_lambda(const RidgePath& path, Index samples);

/// How many standard errors the leave-one-out error at `lambda` lies below that of the mean alone: the mean over
/// samples of the difference of squared errors, divided by its standard error. Zero for the mean itself.
VERNIER_API double evidence_against_mean(const RidgePath& path, double lambda, Index samples);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/least_squares.ipp"
#endif
