// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sample quantiles, and a quantile of distances.

#include "vernier/core/types.hpp"

namespace vernier {

/// Sample quantile by linear interpolation between order statistics (Hyndman and Fan's type 7, the default of R and
/// NumPy): 0 is the minimum, 0.5 the median, 1 the maximum.
/// @throws std::invalid_argument without values, for a value that is not a number or `probability` outside [0, 1]
/// @complexity O(n log n)
/// @cite Hyndman and Fan 1996
VERNIER_API double quantile(const ConstVectorRef& values, double probability);

/// Radius of a ball around the mean of a normal distribution in space that contains 95 % of it, by the chi-square
/// distribution with the same first two moments of the squared distance.
/// @cite Satterthwaite 1946; Wilson and Hilferty 1931
VERNIER_API double radius_95(const Matrix3& covariance) noexcept;

namespace detail {

/// Quantile of values that are in ascending order, as `quantile` defines it.
VERNIER_API double quantile_of_sorted(const ConstVectorRef& values, double probability);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/quantile.ipp"
#endif
