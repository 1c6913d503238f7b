#pragma once

/// @file
/// Numbers in sentences.

#include <cstdio>
#include <string>

namespace vernier::detail {

/// A number in three significant digits.
inline std::string brief(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", value);
  return buffer;
}

}  // namespace vernier::detail
