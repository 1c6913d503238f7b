// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Choices between fits by the errors of left-out poses, with the one-standard-error rule.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Errors of left-out poses under one of several candidate priors.
struct PriorTrial {
  double precision;  ///< of the prior, relative to its expected scale; larger is tighter
  VectorX errors;    ///< one a pose that was left out
};

/// The one-standard-error rule: of trials in order of precision, the index of the tightest whose mean error exceeds the
/// smallest one by no more than a standard error of the paired differences. The last trial where errors are not finite.
/// @param trials at least one
/// @cite Breiman 1984; Hastie 2009
VERNIER_API std::size_t one_standard_error_rule(const std::vector<PriorTrial>& trials);

/// Whether additional unknowns predict left-out poses worse: with them the mean error is larger by more than a standard
/// error of the paired differences.
/// @param with,without errors of the same poses, predicted with the unknowns and without
/// @return             true where errors are not finite
/// @cite Hastie 2009
VERNIER_API bool predicts_worse(const VectorX& with, const VectorX& without);

/// A relative precision that suppresses unknowns.
inline constexpr double suppressing_precision = 1e12;

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/prior_choice.ipp"
#endif
