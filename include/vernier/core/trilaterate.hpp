// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The place of a fixed point from its distances.

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// The fixed point at given distances from points, by linear least squares on squared distances. Points on a plane
/// leave open on which side of it the fixed point lies: then it is put on the plane.
/// @param points    n >= 1 rows
/// @param distances n values
/// @throws std::invalid_argument when the numbers differ
VERNIER_API Vector3 trilaterate(const PointRows& points, const VectorX& distances);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/trilaterate.ipp"
#endif
