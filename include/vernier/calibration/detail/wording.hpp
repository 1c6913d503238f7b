#pragma once

/// @file
/// Numbers in sentences.

#include <cmath>
#include <cstdio>
#include <string>

#include "vernier/core/language.hpp"

namespace vernier::detail {

/// A number in three significant digits; from a thousand to a million all before the point.
inline std::string brief(double value) {
  char buffer[32];
  const double size = std::abs(value);
  std::snprintf(buffer, sizeof buffer, size >= 999.5 && size < 999999.5 ? "%.0f" : "%.3g", value);
  return buffer;
}

}  // namespace vernier::detail
