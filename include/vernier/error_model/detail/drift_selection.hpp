// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether bases and joints' zeros drifted during a session, and how fast.

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// Lets the bases drift, if they do; then the joints' zeros beside them, likewise.
/// @return whether the bases drift
VERNIER_API bool add_drift(ModelSelection& model);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/drift_selection.ipp"
#endif
