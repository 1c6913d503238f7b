// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Ridge regression on many given features: for every lambda, with sample weights, from one symmetric decomposition.

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// One ridge regression and its uncertainty: along a direction d of features the coefficients have the variance
/// `sum_k gain_k (direction_k'd)^2 + rest (|d|^2 - sum_k (direction_k'd)^2)`, in units of the variance of the noise.
struct FeatureRidgeFit {
  double lambda;         ///< infinity: the mean alone
  MatrixX coefficients;  ///< f x m
  VectorX offset;        ///< m
  VectorX noise;         ///< variance of a measurement of weight 1, m
  MatrixX directions;    ///< f x k
  VectorX gain;          ///< k
  double rest;           ///< 0 where the directions are all there are
};

/// `min sum_i q_i |y_i - c - B'z_i|^2 + lambda |B|^2`, the mean c free, as a function of lambda.
///
/// The counterpart of `RidgePath` for hundreds of features: eigenvectors of the products of features, or of
/// samples where those are fewer (the dual form), replace the singular vectors. Products know no singular value below
/// 1e-7 of the largest; where lambda is so small that those count, a QR decomposition of the samples takes over.
/// @complexity n f min(n, f) + 9 min(n, f)^3, then n min(n, f) for each lambda
class FeatureRidge {
 public:
  /// @param features n x f
  /// @param targets  n x m
  /// @param weights  q, n; null for ones
  VERNIER_API FeatureRidge(const ConstMatrixRef& features, const ConstMatrixRef& targets, const VectorX* weights);

  /// Sum of the weights.
  double total_weight() const { return total_; }
  /// Weighted mean of the features.
  const VectorX& mean_features() const { return mean_features_; }

  /// At `lambda` > 0; infinity is the mean alone.
  VERNIER_API FeatureRidgeFit fit(double lambda) const;

  /// The fit of least leave-one-out error among half decades of lambda from the largest square down to 1e-13 of it,
  /// and infinity. Where the least one is best and the samples are more than the features, 1e-20 is tried as well:
  /// such samples have no noise.
  VERNIER_API FeatureRidgeFit best_fit() const;

  /// Mean squared error of leaving out one unit of weight at a time (a whole sample where that has less), each of
  /// `lambdas` > 0; infinity is the mean alone. @cite Allen 1974
  VERNIER_API VectorX leave_one_out(const VectorX& lambdas) const;

 private:
  static constexpr double least = 1e-13;  // lambda, in units of the largest square, that products can tell

  double largest() const { return squares_.size() > 0 ? squares_(squares_.size() - 1) : 0; }

  /// Weighted residuals of coefficients.
  VERNIER_API MatrixX residual_of(const MatrixX& beta) const;

  VERNIER_API double left_out_error(const MatrixX& residual, const VectorX& one_minus_leverage) const;

  VERNIER_API FeatureRidgeFit from_samples(double lambda) const;

  VERNIER_API FeatureRidgeFit finish(double lambda, const MatrixX& beta, double used, const MatrixX& directions,
                                     const VectorX& gain, double rest) const;

  VectorX weights_;
  double total_;
  VectorX mean_features_, mean_targets_;
  MatrixX features_, targets_;  // centred, times the roots of the weights
  VectorX squares_;
  MatrixX left_, right_, projected_;  // singular vectors, n x k and f x k; left' targets
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/feature_ridge.ipp"
#endif
