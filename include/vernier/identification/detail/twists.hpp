// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Small motions of a pose, and columns of its derivatives: linear part first.

#include "vernier/least_squares/row_block.hpp"

namespace vernier::detail {

/// A pose after a small motion: shifted, and turned about its own point.
VERNIER_API Isometry3 shifted(const Isometry3& pose, const Vector6& by);

/// Effect of a twist of a frame on a pose that is rigid with it.
/// @param lever from the point at which the twist is taken to that of the pose [m]
VERNIER_API Matrix6 effect_of_twist(const Vector3& lever);

/// Turns both parts of each column.
VERNIER_API void turn_columns(const Matrix3& rotation, Rows6& columns);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/twists.ipp"
#endif
