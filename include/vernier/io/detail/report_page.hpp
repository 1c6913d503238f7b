// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The script and the style of a report, the same in all. They stand in files of their own, which are JavaScript and
/// CSS but for their first and last lines: those make a file a string literal, so that it can be included here.

#include <string_view>

namespace vernier::detail {

/// A file from its second line on.
constexpr std::string_view from_second_line(std::string_view literal) { return literal.substr(1); }

/// Turns the view of poses: pointer, keys, buttons and the fragment of the address.
inline constexpr std::string_view report_script = from_second_line(
#include "vernier/io/detail/report.js"
);

/// Colours by custom properties, so that the dark and the printed page differ in them alone.
inline constexpr std::string_view report_style = from_second_line(
#include "vernier/io/detail/report.css"
);

}  // namespace vernier::detail
