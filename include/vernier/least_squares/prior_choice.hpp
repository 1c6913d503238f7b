#pragma once

/// @file
/// The scale of a prior, and whether unknowns are included, by leave-one-block-out validation with the
/// one-standard-error rule.

#include <vector>

#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier {

/// Errors of validation blocks under one of several candidate priors.
struct PriorTrial {
  double precision;  ///< of the prior, relative to its expected scale; larger is tighter
  VectorX errors;    ///< one a pose that was left out
};

/// The one-standard-error rule: of trials in order of precision, the index of the tightest whose mean error exceeds the
/// smallest one by no more than a standard error of the paired differences. The last trial where errors are not finite.
/// @param trials at least one
/// @cite Breiman 1984; Hastie 2009
VERNIER_API std::size_t one_standard_error_rule(const std::vector<PriorTrial>& trials);

/// Whether the errors of left-out blocks support additional unknowns: with them the mean error is smaller by more than
/// a standard error of the paired differences.
/// @param with,without the same blocks, predicted with the unknowns and without
/// @return             false where errors are not finite
/// @cite Hastie 2009
VERNIER_API bool errors_support(const LeftOutBlocks& with, const LeftOutBlocks& without);

/// Whether the log predictive densities of left-out blocks do, by the same rule, and the mean error is smaller at all.
/// Densities know which blocks could not be predicted well, as is usual among few that were planned.
/// @param with,without as for `errors_support`
/// @cite Vehtari 2017
VERNIER_API bool densities_support(const LeftOutBlocks& with, const LeftOutBlocks& without);

/// Outcome of `choose_prior`.
struct PriorChoice {
  double precision;         ///< relative, see `PriorTrial`
  double chosen_error;      ///< mean leave-one-out error with it [m]
  double smallest_error;    ///< smallest mean leave-one-out error of all trials [m]
  double suppressed_error;  ///< mean leave-one-out error with the unknowns suppressed [m]
};

/// A relative precision that suppresses unknowns.
inline constexpr double suppressing_precision = 1e12;

/// Tries priors for a range of unknowns, from looser than expected to suppression, at the linearised problem, and
/// applies the one-standard-error rule.
/// @param system,normal the problem, and its normal equations
/// @param precisions    of all priors
/// @param steps         present values of the unknowns
/// @param first,count   the range
/// @param stride        every stride-th validation block is left out
VERNIER_API PriorChoice choose_prior(const BlockSystem& system, const NormalEquations& normal, VectorX precisions,
                                     const VectorX& steps, Index first, Index count, Index stride);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/prior_choice.ipp"
#endif
