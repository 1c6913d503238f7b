// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which sets of measurements have a base frame, or a tool, in common.

#include <span>
#include <vector>

#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// One unknown for each base frame, or each tool, of some sets; its parameter is yet to be named. Sets of one place
/// have one base, sets of one point have one tool.
/// @param sets      all sets
/// @param base      whether bases are meant, not tools
/// @param own_tools whether every set has a tool of its own
/// @param last      sets before this one are meant
VERNIER_API std::vector<GeometricUnknown> frame_of_sets(std::span<const MeasuredSet> sets, bool base, bool own_tools,
                                                        std::size_t last);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/frame_sharing.ipp"
#endif
