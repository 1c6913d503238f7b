// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/detail/number_text.hpp"

#include <charconv>
#include <cmath>

namespace vernier::detail {

/// A number in one of the formats of `std::to_chars`, which knows no locale.
VERNIER_LOCAL std::string rounded_text(double value, std::chars_format format, int precision) {
  char text[400];  // 309 digits before the point, at most 60 behind it
  return {text, std::to_chars(text, text + sizeof text, value, format, precision < 60 ? precision : 60).ptr};
}

VERNIER_IMPL std::string fixed_digits(double value, int decimals) {
  return rounded_text(value, std::chars_format::fixed, decimals);
}

VERNIER_IMPL std::string signed_digits(double value, int decimals) {
  return (std::signbit(value) ? "" : "+") + fixed_digits(value, decimals);
}

VERNIER_IMPL std::string significant_digits(double value, int digits) {
  return rounded_text(value, std::chars_format::general, digits);
}

VERNIER_IMPL std::string brief(double value) {
  const double size = std::abs(value);
  return size >= 999.5 && size < 999999.5 ? fixed_digits(value, 0) : significant_digits(value, 3);
}

VERNIER_IMPL std::string three_digits(double value) {
  const std::string text = rounded_text(value, std::chars_format::scientific, 2);  // as 1.23e-04
  if (!std::isfinite(value)) return text;
  const std::size_t e = text.find('e');
  if (text.find_first_of("123456789") > e) return "0";
  int exponent = 0;
  std::from_chars(text.data() + e + (text[e + 1] == '+' ? 2 : 1), text.data() + text.size(), exponent);
  return exponent < -5 || exponent > 5 ? text : fixed_digits(value, exponent < 2 ? 2 - exponent : 0);
}

VERNIER_IMPL std::string at_right(const std::string& text, std::size_t width) {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

VERNIER_IMPL std::string at_left(const std::string& text, std::size_t width) {
  return text + std::string(width > text.size() ? width - text.size() : 0, ' ');
}

}  // namespace vernier::detail
