#pragma once

/// @file
/// The spectrum of a joint's errors: how large each order is by the measurements alone, and how significant.

#include <vector>

#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// One order of the errors of a joint, as the measurements show it: without its own prior, beside everything else in
/// the model.
struct HarmonicEstimate {
  int order = 0;          ///< periods a turn
  double amplitude = 0;   ///< [rad]
  double std = 0;         ///< standard deviation of the amplitude [rad]
  double chi_square = 0;  ///< of its two coefficients against zero: 2 degrees of freedom

  /// Half the width of a 95 % interval of the amplitude.
  double margin() const { return 1.96 * std; }
};

/// Estimates of all orders of a joint, ascending; without those that the measurements do not determine.
/// @param joint from 0
/// @complexity O(orders)
VERNIER_API std::vector<HarmonicEstimate> joint_spectrum(const ErrorModelEstimate& estimate, int joint);

/// The chi-square that the largest of a number of orders of noise exceeds in one case of a hundred.
VERNIER_API double line_threshold(Index trials);

/// Lines of a spectrum: orders that exceed a chi-square, the largest first, each the largest of its neighbours up to
/// four orders away.
VERNIER_API std::vector<HarmonicEstimate> lines_in(const std::vector<HarmonicEstimate>& spectrum, double threshold);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/joint_spectrum.ipp"
#endif
