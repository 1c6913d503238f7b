// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Robust loss functions, as weights of iteratively reweighted least squares.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// How residuals are weighted.
enum class Loss {
  squared,  ///< least squares
  huber,   ///< linear beyond a threshold of 2.8 sigma of a 3-vector (1.345 sigma of a number), sigma estimated robustly
  cauchy,  ///< logarithmic, likewise
};

/// Weight of a residual of norm r > 0, in (0, 1]: the derivative of the loss with respect to r^2.
/// @param loss      the loss
/// @param norm      of the residual
/// @param threshold where the loss leaves the square, > 0
/// @cite Huber 1964; Holland and Welsch 1977
VERNIER_API double robust_weight(Loss loss, double norm, double threshold);

/// Median of the norm of three standard normal components, to four digits.
inline constexpr double median_norm = 1.538;
/// 95 % of the squared norms of three standard normal components are below: chi-square with three degrees of freedom.
inline constexpr double chi_square_95 = 7.8147;

/// Robust estimate of the standard deviation of the components of residuals, from the median of their norms. 0 for no
/// residuals.
/// @param norms     of residuals
/// @param dimension of each residual: 1 or 3
VERNIER_API double robust_sigma(std::vector<double> norms, int dimension);

/// The threshold of a robust loss for residuals of some norms: 1.345 (dimension 1) or 2.8 (dimension 3) times their
/// `robust_sigma`.
VERNIER_API double robust_threshold(std::vector<double> norms, int dimension);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/loss.ipp"
#endif
