// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rigid registration of corresponding points in closed form.

#include "vernier/core/types.hpp"

namespace vernier {

/// The rotation nearest to a matrix (in the Frobenius norm), e.g. the mean of a sum of rotations.
VERNIER_API Matrix3 nearest_rotation(const Matrix3& matrix);

/// The rigid motion that takes `from` to `to` with the smallest sum of squared distances; never a reflection.
/// @param from n >= 1 points, n x 3
/// @param to   the corresponding points
/// @throws std::invalid_argument when the numbers of points differ
/// @cite Kabsch 1976; Umeyama 1991
VERNIER_API Isometry3 register_points(const PointRows& from, const PointRows& to);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/register_points.ipp"
#endif
