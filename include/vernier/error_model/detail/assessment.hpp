// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How exact a fitted error model is: covariance of its unknowns, noise of a visit, leave-one-pose-out errors.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Adds the covariance of the unknowns, the noise of a visit and leave-one-pose-out errors to an estimate of the
/// model's unknowns.
VERNIER_API void assess(const ModelSelection& model, ErrorModelEstimate& estimate);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/assessment.ipp"
#endif
