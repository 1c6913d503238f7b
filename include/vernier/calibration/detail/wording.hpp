#pragma once

/// @file
/// Numbers in sentences.

#include <cmath>
#include <cstdio>
#include <string>

namespace vernier::detail {

/// A number in three significant digits, from 1000 on all before the point.
inline std::string brief(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, std::abs(value) < 999.5 ? "%.3g" : "%.0f", value);
  return buffer;
}

}  // namespace vernier::detail
