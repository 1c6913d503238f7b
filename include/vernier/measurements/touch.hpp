// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What touches of all objects have in common.

#include "vernier/measurements/sensor.hpp"

namespace vernier::detail {

/// The tool point of registered poses is known to millimetres.
inline constexpr Plausibility plausible_touches{0.02, "the tool point of the poses misses it by",
                                                "another tool point, wrong units, columns or rows?"};

/// The smallest rotation that takes a unit vector to the z axis.
VERNIER_API Matrix3 rotation_to_z(const Vector3& direction);
/// The normal of a plane through points at some heights above it; its sign follows from the heights where they differ.
VERNIER_API Vector3 fitted_normal(const PointRows& points, const VectorX& heights);
/// Sum of deviations of points from their mean, each times that of its height: the direction in which heights rise.
VERNIER_API Vector3 rise_of(const PointRows& points, const VectorX& heights);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/touch.ipp"
#endif
