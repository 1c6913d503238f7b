// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Lines: orders of a transmission that stand out of what a fitted model leaves, those of gears and encoders.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Adds orders that stand out of what the model leaves, if leave-one-pose-out errors support them.
/// @return whether they do
VERNIER_API bool find_lines(ModelSelection& model);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/line_search.ipp"
#endif
