#pragma once

/// @file
/// Blocks of measurements left out one at a time, in closed form.

#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier {

/// Validation blocks left out one at a time.
struct LeftOutBlocks {
  Eigen::Matrix3Xd errors;  ///< of positions, a column a block [m]; infinite where there is no solution
  /// Log predictive densities: of each block's measured values, predicted by all others, up to a constant [nat]. The
  /// variance of the whitened noise has its most likely value for these blocks. Not finite where there is no solution.
  VectorX log_densities;
};

/// Predicts blocks from all others, in closed form, at the solution of the linearised problem with given priors: the
/// whitened error is `e_b = (I - H_bb)^-1 r_b`, its covariance that of the noise times `(I - H_bb)^-1`.
/// @param system the problem
/// @param solved its normal equations with priors
/// @param stride every stride-th of the validation blocks is left out
/// @return       ceil(validation_blocks / stride) blocks
/// @cite Allen 1974; Vehtari 2017 (log predictive densities)
VERNIER_API LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride);

/// Position errors of `leave_one_out`, 3 x ceil(validation_blocks / stride) [m].
VERNIER_API Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                  Index stride);

namespace detail {

/// Norm of the position error of each block [m].
VERNIER_API VectorX error_norms(const Eigen::Matrix3Xd& errors);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/leave_one_out.ipp"
#endif
