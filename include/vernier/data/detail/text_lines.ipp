// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/detail/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string text_of(const std::string& path) {
  try {
    constexpr std::size_t largest = std::size_t{256} << 20;  // bytes
    return read_file(path, largest);
  } catch (const std::invalid_argument& e) {
    throw DataError(e.what());
  }
}

VERNIER_IMPL std::vector<TextLine> text_lines(const std::string& file, std::string_view content) {
  std::vector<TextLine> out;
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF"))
    throw DataError(file + ", line 1: binary data, not text (UTF-16? Save it as UTF-8)");
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  for (std::size_t number = 1; !content.empty(); ++number) {
    const std::size_t end = (std::min)(content.find_first_of("\r\n"), content.size());
    const std::string_view line = content.substr(0, end);
    content.remove_prefix(end);
    if (!content.empty()) content.remove_prefix(content.starts_with("\r\n") ? 2 : 1);
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    if (line.find('\0') != std::string_view::npos)
      throw DataError(message(file, ", line ", number, ": binary data, not text"));
    if (out.size() > most_rows) throw DataError(message(file, ": has more than ", most_rows, " rows"));
    out.push_back({number, line});
  }
  return out;
}

VERNIER_IMPL std::string_view trimmed(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string_view{} : cell.substr(first, last - first + 1);
}

VERNIER_IMPL std::string printable(std::string_view cell) {
  std::string out;
  for (const char c : cell.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (cell.size() > 40 ? "..." : "");
}

VERNIER_IMPL std::string name_of_separator(char separator) {
  return separator == ' '    ? std::string("blanks")
         : separator == '\t' ? std::string("tabs")
                             : message("'", printable({&separator, 1}), "'");
}

VERNIER_IMPL std::vector<std::string_view> cells_of(std::string_view line, char separator,
                                                    FunctionRef<std::string()> where) {
  const std::string_view blanks = " \t";
  const auto skip_blanks = [&](std::size_t from) {
    while (from < line.size() && line[from] != separator && blanks.find(line[from]) != std::string_view::npos) ++from;
    return separator == ' ' ? (std::min)(line.find_first_not_of(blanks, from), line.size()) : from;
  };
  std::vector<std::string_view> out;
  for (std::size_t at = 0; out.size() <= most_columns;) {
    at = skip_blanks(at);
    if (separator == ' ' && at == line.size()) break;
    std::size_t end = 0;
    if (at < line.size() && line[at] == '"') {
      const std::size_t close = line.find('"', at + 1);
      if (close == std::string_view::npos) throw DataError(where() + "a quotation mark without its partner");
      out.push_back(trimmed(line.substr(at + 1, close - at - 1)));
      end = separator == ' ' ? close + 1 : skip_blanks(close + 1);
      const bool ends = end == line.size() || line[end] == separator || (separator == ' ' && line[end] == '\t');
      if (!ends) throw DataError(where() + "text behind a closing quotation mark");
    } else {
      end = (std::min)(separator == ' ' ? line.find_first_of(blanks, at) : line.find(separator, at), line.size());
      out.push_back(trimmed(line.substr(at, end - at)));
    }
    if (end == line.size()) break;
    at = end + 1;
  }
  return out;
}

/// The number that all of a text is, with a decimal point; infinite or NaN, too.
/// @return no error where it is one
VERNIER_LOCAL std::errc parse_number(std::string_view digits, double& value) {
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc{} && end != digits.data() + digits.size() ? std::errc::invalid_argument : error;
}

/// Why a cell is no number, as far as that is known.
VERNIER_LOCAL const char* advice_on(std::string_view cell, char decimal) {
  for (const char c : cell)
    if (static_cast<unsigned char>(c) >= 0x80) return "; a sign or a blank in it is not ASCII";
  std::string with_point(cell);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  double value = 0;
  if (parse_number(with_point, value) == std::errc{}) {
    if (decimal == '.' && cell.find(',') != std::string_view::npos)
      return "; if its comma is a decimal one: --decimal ',' (format.decimal in code)";
    if (decimal == ',' && cell.find('.') != std::string_view::npos)
      return "; if its point is a decimal one: --decimal . (format.decimal in code)";
  }
  for (char& c : with_point)
    if (c == 'D' || c == 'd') c = 'e';
  return parse_number(with_point, value) == std::errc{} ? "; an exponent begins with E" : "";
}

VERNIER_IMPL double number_in(std::string_view cell, char decimal, FunctionRef<std::string()> where) {
  const auto fail = [&](const auto&... what) {
    throw DataError(message(where(), "'", printable(cell), "' ", what...));
  };
  if (cell.empty()) throw DataError(where() + "no value");
  std::string_view digits = cell;
  std::string with_point;
  if (decimal != '.') {
    if (cell.find('.') != std::string_view::npos) fail("is not a number", advice_on(cell, decimal));
    with_point = cell;
    std::replace(with_point.begin(), with_point.end(), decimal, '.');
    digits = with_point;
  }
  double out = 0;
  const std::errc error = parse_number(digits, out);
  if (error == std::errc::result_out_of_range) fail("is out of range");
  if (error != std::errc{}) fail("is not a number", advice_on(cell, decimal));
  if (!std::isfinite(out)) fail("is not finite");
  return out;
}

}  // namespace vernier::detail
