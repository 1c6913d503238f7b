// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The spectrum of a joint's errors: the amplitude of each order by the measurements alone, and its significance.

#include <vector>

#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// One order of a joint's errors, estimated together with everything else in the model, but without its own prior.
struct HarmonicEstimate {
  int order = 0;          ///< periods a turn
  double amplitude = 0;   ///< [rad]
  double std = 0;         ///< standard deviation of the amplitude [rad]
  double chi_square = 0;  ///< of the test that both its coefficients are zero: 2 degrees of freedom

  /// Half the width of a 95 % interval of the amplitude.
  double margin() const { return 1.96 * std; }
};

/// Estimates of all orders of a joint, ascending; without those that the measurements do not determine.
/// @param estimate of the error model
/// @param joint    from 0
/// @complexity O(orders)
VERNIER_API std::vector<HarmonicEstimate> joint_spectrum(const ErrorModelEstimate& estimate, int joint);

/// The chi-square that the largest of some orders exceeds by chance in one case of a hundred, where all are noise.
/// @param trials number of orders that are looked at
VERNIER_API double line_threshold(Index trials);

/// Lines of a spectrum: orders whose chi-square exceeds a threshold, by falling amplitude. Of neighbours, at most four
/// orders and a quarter of the order apart, only the largest is a line.
VERNIER_API std::vector<HarmonicEstimate> lines_in(const std::vector<HarmonicEstimate>& spectrum, double threshold);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/joint_spectrum.ipp"
#endif
