// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Lines, cells and numbers of text files, and what is said of those that are not.

#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// A line of a file.
struct TextLine {
  std::size_t number;     ///< counted from 1
  std::string_view text;  ///< without the end of the line
};

/// The content of a file of at most 256 MiB.
/// @throws DataError where it cannot be read
VERNIER_API std::string text_of(const std::string& path);

// What a table may have, so that a file that is none does not fill the memory.
inline constexpr std::size_t most_columns = 1000, most_rows = 1'000'000;

/// The lines that are not blank, without a byte-order mark; they end with LF, CRLF or CR.
/// @param file    its name, for messages
/// @param content the text, which must outlive the lines
/// @throws DataError on binary data, on UTF-16, and on more lines than `most_rows` below a header
VERNIER_API std::vector<TextLine> text_lines(const std::string& file, std::string_view content);

/// A cell without blanks around it.
VERNIER_API std::string_view trimmed(std::string_view cell);

/// The text of a cell for a message: shortened, and with printable ASCII characters only.
VERNIER_API std::string printable(std::string_view cell);

/// A separator for a message: 'blanks', 'tabs', or itself in quotation marks.
VERNIER_API std::string name_of_separator(char separator);

/// The cells of a line, without blanks and quotation marks around them; of a line that has more than `most_columns`,
/// one more than these. What is between quotation marks is one cell.
/// @param separator a blank stands for any number of blanks and tabs
/// @param where     what a message begins with
/// @throws DataError on quotation marks that do not enclose a cell
VERNIER_API std::vector<std::string_view> cells_of(std::string_view line, char separator,
                                                   FunctionRef<std::string()> where);

/// The number in a cell, finite.
/// @param decimal the decimal point
/// @param where   what a message begins with
/// @throws DataError
VERNIER_API double number_in(std::string_view cell, char decimal, FunctionRef<std::string()> where);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/text_lines.ipp"
#endif
