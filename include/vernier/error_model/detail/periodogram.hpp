#pragma once

/// @file
/// The periodogram of what a model leaves: which order of a joint's angle, were it added, would explain how much.

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Chi-square (2 degrees of freedom) of adding each of the orders 1 .. highest to a joint.
/// @param angles of the joint [rad]
/// @param score  of each block: whitened residual times the effect of a unit error of the joint
/// @param weight of each block: squared norm of that effect
/// @cite Lomb 1976
VERNIER_API VectorX periodogram(const ConstVectorRef& angles, const ConstVectorRef& score, const ConstVectorRef& weight,
                                int highest);

/// Whether the angles tell orders apart: no two of them, up to the highest, are the same at most of the angles, as they
/// would be on a grid.
VERNIER_API bool tells_orders_apart(const ConstVectorRef& angles, const ConstVectorRef& weight, int highest);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/periodogram.ipp"
#endif
