// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Bound handling: where a coordinate goes that left its interval.

#include <algorithm>
#include <cmath>

#include "vernier/core/language.hpp"

namespace vernier {

/// x reflected at the bounds, as often as needed, into [lower, upper]; x itself where it lies between them.
inline double reflected(double x, double lower, double upper) {
  if (x >= lower && x <= upper) return x;
  const double width = upper - lower;
  const double at = std::fmod(std::abs(x - lower), 2 * width);
  return std::clamp(lower + (at > width ? 2 * width - at : at), lower, upper);
}

/// x, or where it left [lower, upper] the midpoint between the bound it violates and `inside`.
/// @cite Zhang and Sanderson 2009
inline double halfway(double x, double inside, double lower, double upper) {
  return x < lower ? lower + (inside - lower) / 2 : x > upper ? upper + (inside - upper) / 2 : x;
}

/// What happens to a trial's coordinate that leaves the box.
enum class TrialRule {
  halfway,  ///< put halfway between the target individual and the bound
  redrawn,  ///< drawn anew, uniformly in its interval: prevents premature convergence
};

}  // namespace vernier
