#pragma once

/// @file
/// Words of reports.

#include <cstdio>
#include <string>
#include <vector>

#include "vernier/core/language.hpp"

namespace vernier::detail {

/// A number with some digits behind the point.
inline std::string fixed_digits(double value, int digits) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
  return buffer;
}

/// Texts joined by commas.
inline std::string comma_list(const std::vector<std::string>& texts) {
  std::string out;
  for (const auto& text : texts) out += (out.empty() ? "" : ", ") + text;
  return out;
}

}  // namespace vernier::detail
