// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The periodogram of a model's residuals over a joint's angle: how much of them each order would explain, if it were
/// added to the model.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Chi-square (2 degrees of freedom) of adding each of the orders 1 .. highest to a joint.
/// @param angles of the joint [rad]
/// @param score  of each block: whitened residual times the effect of a unit error of the joint
/// @param weight of each block: squared norm of that effect
/// @cite Lomb 1976
VERNIER_API VectorX periodogram(const VectorX& angles, const VectorX& score, const VectorX& weight, int highest);

/// Orders beside known ones whose chi-square exceeds a threshold, at most eight, the largest first: each is taken off
/// before the next is looked for, so that none is the echo of another.
/// @param angles,score,weight as in `periodogram`
/// @param known     ascending
/// @param highest   order
/// @param threshold of the chi-square
VERNIER_API std::vector<int> lines_of_residuals(const VectorX& angles, VectorX score, const VectorX& weight,
                                                const std::vector<int>& known, int highest, double threshold);

/// Whether measurements at these angles distinguish the orders 1 .. highest; on a grid of angles they do not, because
/// different orders take the same values there (aliasing).
VERNIER_API bool tells_orders_apart(const VectorX& angles, const VectorX& weight, int highest);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/periodogram.ipp"
#endif
