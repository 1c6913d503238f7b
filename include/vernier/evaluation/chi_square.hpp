// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The chi-square distribution.

#include "vernier/core/api.hpp"

namespace vernier {

/// Probability that a chi-square with some degrees of freedom exceeds a value: the regularised incomplete gamma
/// function Q(dof / 2, x / 2), by its series or its continued fraction, to about 1e-12.
/// @param x   at least 0
/// @param dof degrees of freedom, above 0
/// @throws std::invalid_argument outside these
/// @cite Abramowitz and Stegun 1964
VERNIER_API double chi_square_tail(double x, double dof);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/chi_square.ipp"
#endif
