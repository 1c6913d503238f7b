// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whole sessions left out: what holds on another day.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Mean position error of each session, predicted from all other sessions and fifteen of its own poses, which tell
/// where its base is [m]. A session is a set of measurements that locates its base.
/// @param precisions of the priors of all unknowns
/// @return           one value a session; none with fewer than two sessions, or where one has too few poses
/// @complexity       O(sessions n u^2)
VERNIER_API VectorX errors_of_left_out_sessions(const ModelSelection& model, const VectorX& precisions);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/left_out_sessions.ipp"
#endif
