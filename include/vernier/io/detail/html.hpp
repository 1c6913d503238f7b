// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Text in HTML: escaped, and numbers in it.

#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// A text for the content of an element or a quoted attribute: `&<>"'` escaped, control characters and what is no UTF-8
/// replaced.
VERNIER_API std::string html_escape(std::string_view text);
/// JSON for a script element: no `<` is left, which JSON has in strings alone, so nothing in it ends the element.
VERNIER_API std::string script_escape(std::string_view json);
/// A whole number of tenths, without a decimal that is zero.
VERNIER_API std::string tenths(double value);
/// The hexadecimal digits of a digest in base 64, as content security policies write it.
VERNIER_API std::string base64_of_hex(std::string_view hex);

/// A table; its texts are escaped by `html_table`.
struct HtmlTable {
  std::string caption{};                         ///< above it; empty for none
  std::vector<std::string> head{};               ///< of the columns
  std::vector<std::vector<std::string>> rows{};  ///< the first cell of each is its heading
  bool numbers = true;                           ///< columns of numbers are right-aligned
};
/// A table whose headings have scopes; empty without rows.
VERNIER_API std::string html_table(const HtmlTable& table);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/html.ipp"
#endif
