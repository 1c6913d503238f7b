// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where touched objects are: the frame of each, in which the arm that touches it stands.

#include <vector>

#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// The parameters of the base frame that a set determines.
VERNIER_API std::vector<Index> frame_unknowns(const MeasuredSet& set);

/// Requires that the touches of a plane are spread over it, and not along a line.
/// @param arm in the frame of the plane
/// @throws std::invalid_argument naming the set
VERNIER_API void require_spread(const ArmGeometry& arm, const MeasuredSet& set);

/// Joint values, the nearest ones, at which touches lie on their object exactly.
/// @param arm in the frame of the set
VERNIER_API MatrixX touching_joints(const ArmGeometry& arm, const MeasuredSet& set);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/contact_frames.ipp"
#endif
