#pragma once

/// @file
/// What becomes of a coordinate that leaves its interval.

#include <algorithm>
#include <cmath>

namespace vernier {

/// The mirror image of x in [lower, upper], both ends being mirrors; x itself where it lies between them.
inline double reflected(double x, double lower, double upper) {
  if (x >= lower && x <= upper) return x;
  const double width = upper - lower;
  const double at = std::fmod(std::abs(x - lower), 2 * width);
  return std::clamp(lower + (at > width ? 2 * width - at : at), lower, upper);
}

/// x, or where it left [lower, upper] the middle between the bound it passed and `inside`.
/// @cite Zhang and Sanderson 2009
inline double halfway(double x, double inside, double lower, double upper) {
  return x < lower ? lower + (inside - lower) / 2 : x > upper ? upper + (inside - upper) / 2 : x;
}

}  // namespace vernier
