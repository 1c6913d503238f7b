// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Look-alikes: errors of joints that few poses cannot tell from each other, as gear ratios and low harmonics.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Compares deflection, functions of joints and gears that were found with the others in their place, whether these are
/// in the model or not. If the evidence of all of them is less than 20 times that of the others alone, the existence of
/// this one is undecided. It stays in the model, where it predicts left-out poses better. From 500 poses on, and where
/// options leave one kind alone, nothing is compared.
/// @param all the terms of the model, and those of the other kinds
/// @complexity some ten factorisations for each effect that was found
/// @cite Kass 1995 (strong evidence)
VERNIER_API void compare_look_alikes(ModelSelection& model, const JointTerms& all);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/look_alikes.ipp"
#endif
