// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether rows follow a path. Then neighbours are alike, and what is known of them says little about other poses.

#include "vernier/core/types.hpp"

namespace vernier {

/// Whether the median step from one row to the next is below half of that between random rows.
/// @param joints n x joints [rad, m]
/// @complexity O(n log n)
VERNIER_API bool rows_are_ordered(const ConstMatrixRef& joints);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/ordered_rows.ipp"
#endif
