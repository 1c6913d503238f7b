// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measurements left out pose by pose, in closed form.

#include "vernier/least_squares/factorised_equations.hpp"

namespace vernier {

/// Validation blocks, each predicted without the blocks of its pose.
struct LeftOutBlocks {
  Eigen::Matrix3Xd errors;     ///< of positions, a column a block [m]; infinite where there is no solution
  std::vector<Index> poses{};  ///< of each column; empty where each block is of a pose of its own
};

/// Predicts blocks from those of all other poses, in closed form, at the solution of the linearised problem with given
/// priors: the whitened errors of the blocks b of a pose are `e_b = (I - H_bb)^-1 r_b`.
/// @param system the problem
/// @param solved its normal equations with priors
/// @param stride every stride-th of the validation blocks is left out
/// @return       ceil(validation_blocks / stride) blocks
/// @cite Allen 1974
VERNIER_API LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride);

/// Position errors of `leave_one_out`, 3 x ceil(validation_blocks / stride) [m].
VERNIER_API Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                  Index stride);

namespace detail {

/// Norm of the position error of each block [m].
VERNIER_API VectorX error_norms(const Eigen::Matrix3Xd& errors);
/// Norms of position errors, the mean of each pose [m].
VERNIER_API VectorX error_norms(const LeftOutBlocks& left_out);
/// Means of the values of each pose; the values themselves where no poses are given.
VERNIER_API VectorX means_of_poses(const VectorX& values, const std::vector<Index>& poses);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/leave_one_out.ipp"
#endif
