// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rounded numbers as text, the same under every locale of the host program. Exact ones: `message` of `core/check.hpp`.

#include <cstddef>
#include <string>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// A number with some decimals: "0.050".
VERNIER_API std::string fixed_digits(double value, int decimals);

/// A number with some decimals and its sign in any case: "+0.050".
VERNIER_API std::string signed_digits(double value, int decimals);

/// A number rounded to some significant digits, without zeros at its end: "0.05". Very large and very small numbers
/// have an exponent: "1.2e-07".
VERNIER_API std::string significant_digits(double value, int digits);

/// A number in three significant digits; from a thousand to a million all before the point.
VERNIER_API std::string brief(double value);

/// A number in three significant digits for tables, with zeros at its end: 0.0500, 0.912, 12.0, 1234. Below 1e-5 and
/// from a million on with an exponent.
VERNIER_API std::string three_digits(double value);

/// A text at the right of a column of at least `width` characters.
VERNIER_API std::string at_right(const std::string& text, std::size_t width);

/// A text at the left of a column of at least `width` characters.
VERNIER_API std::string at_left(const std::string& text, std::size_t width);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/number_text.ipp"
#endif
