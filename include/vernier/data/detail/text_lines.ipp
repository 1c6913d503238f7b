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
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  for (std::size_t number = 1; !content.empty(); ++number) {
    const std::size_t end = content.find('\n');
    std::string_view line = content.substr(0, end);
    content.remove_prefix(end == std::string_view::npos ? content.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
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

VERNIER_IMPL double number_in(std::string_view cell, char decimal, FunctionRef<std::string()> where) {
  const auto fail = [&](const char* what) { throw DataError(message(where(), "'", printable(cell), "' ", what)); };
  if (cell.empty()) throw DataError(where() + "no value");
  std::string_view digits = cell;
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  std::string with_point;
  if (decimal != '.') {
    if (digits.find('.') != std::string_view::npos) fail("is not a number");
    with_point = digits;
    std::replace(with_point.begin(), with_point.end(), decimal, '.');
    digits = with_point;
  }
  double out = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
  if (error == std::errc::result_out_of_range) fail("is out of range");
  if (error != std::errc{} || end != digits.data() + digits.size()) fail("is not a number");
  if (!std::isfinite(out)) fail("is not finite");
  if (std::abs(out) > 1e9) fail("is beyond any joint or length (1e9)");
  return out;
}

}  // namespace vernier::detail
