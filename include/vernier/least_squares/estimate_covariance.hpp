// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How well a weighted least-squares problem determines its unknowns: rank, condition, covariance.

#include "vernier/core/types.hpp"

namespace vernier {

/// Covariance of the estimate of a weighted least-squares problem with independent priors on some unknowns.
struct EstimateCovariance {
  MatrixX inverse;          ///< (J'J + prior)^-1; empty where it is singular
  MatrixX covariance;       ///< of the unknowns, see the constructor; empty where singular
  Index rank = 0;           ///< of J, without priors
  double condition = 0;     ///< of J, without priors: largest over smallest singular value
  VectorX singular_values;  ///< of J, without priors

  /// The covariance of the minimum of `|J x - r|^2 + x' prior x` where rows and priors have other variances than those
  /// that the minimum assumes: `A^-1 (J' D J + prior V prior) A^-1`, `A = J'J + prior`.
  /// @param jacobian       whitened rows
  /// @param row_variance   D: variance of each whitened row, as estimated from residuals
  /// @param prior          weights of the priors, one a column; zero for none
  /// @param prior_variance V: variance of each prior; where its weight is zero it does not matter
  VERNIER_API EstimateCovariance(const ConstMatrixRef& jacobian, const VectorX& row_variance, const VectorX& prior,
                                 const VectorX& prior_variance);
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/estimate_covariance.ipp"
#endif
