#pragma once

/// @file
/// Numbers in sentences.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
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

/// A number in three significant digits for tables, with zeros at its end: 0.0500, 0.912, 12.0, 1234. Below 1e-5 and
/// from a million on with an exponent.
inline std::string three_digits(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.2e", value);
  if (!std::isfinite(value)) return buffer;
  const std::string text = buffer;
  const long exponent = std::strtol(text.c_str() + text.find('e') + 1, nullptr, 10);
  if (text.find_first_of("123456789") > text.find('e')) return "0";
  if (exponent < -5 || exponent > 5) return text;
  std::snprintf(buffer, sizeof buffer, "%.*f", static_cast<int>((std::max)(0L, 2 - exponent)), value);
  return buffer;
}

}  // namespace vernier::detail
