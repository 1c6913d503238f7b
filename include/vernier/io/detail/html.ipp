// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "vernier/core/check.hpp"
#include "vernier/io/detail/html.hpp"

namespace vernier::detail {

/// Bytes of the UTF-8 character at a place, 0 where there is none.
VERNIER_LOCAL std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return 1;
  const std::size_t n = first >= 0xc2 && first < 0xe0   ? 2
                        : first >= 0xe0 && first < 0xf0 ? 3
                        : first >= 0xf0 && first < 0xf5 ? 4
                                                        : 0;
  if (n == 0 || at + n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  const unsigned char second = byte(at + 1);  // no longer forms, surrogates, or values above the last character
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
      (first == 0xf4 && second > 0x8f) || (first == 0xc2 && second < 0xa0))
    return 0;
  return n;
}

VERNIER_IMPL std::string html_escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = utf8_length(text, i);
    const char c = text[i];
    if (n == 0)
      out += "\xEF\xBF\xBD";
    else if (n > 1)
      out += text.substr(i, n);
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += (c >= ' ' && c != 0x7f) || c == '\n' || c == '\t' ? c : ' ';
    i += n == 0 ? 1 : n;
  }
  return out;
}

VERNIER_IMPL std::string script_escape(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

VERNIER_IMPL std::string tenths(double value) {
  if (!std::isfinite(value) || std::abs(value) > 1e15) return "0";
  const long long whole = std::llround(10 * value), size = whole < 0 ? -whole : whole;
  std::string out = whole < 0 ? "-" : "";
  out += std::to_string(size / 10);
  if (size % 10 != 0) {
    out += '.';
    out += static_cast<char>('0' + size % 10);
  }
  return out;
}

VERNIER_IMPL std::string base64_of_hex(std::string_view hex) {
  static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : hex) {
    bits = bits << 4 | static_cast<std::uint32_t>(c <= '9' ? c - '0' : c - 'a' + 10);
    count += 4;
    if (count < 6) continue;
    count -= 6;
    out += digits[bits >> count & 63];
  }
  if (count > 0) out += digits[bits << (6 - count) & 63];
  while (out.size() % 4 != 0) out += '=';
  return out;
}

VERNIER_IMPL std::string html_table(const HtmlTable& table) {
  if (table.rows.empty()) return "";
  std::string out = table.numbers ? "<div class=\"wide\"><table class=\"num\">\n" : "<div class=\"wide\"><table>\n";
  if (!table.caption.empty()) out += "<caption>" + html_escape(table.caption) + "</caption>\n";
  // columns of text among numbers are left-aligned
  std::vector<const char*> kind(table.head.size(), "");
  for (const auto& row : table.rows)
    for (std::size_t k = 1; k < row.size() && k < kind.size() && table.numbers; ++k)
      if (!row[k].empty() && row[k].find_first_of("0123456789") > 1) kind[k] = " class=\"text\"";
  const auto cell = [&](std::size_t k, const std::string& text) {
    return message("<td", k < kind.size() ? kind[k] : "", ">", html_escape(text), "</td>");
  };
  out += "<thead><tr>";
  for (std::size_t k = 0; k < table.head.size(); ++k)
    out += message("<th scope=\"col\"", kind[k], ">", html_escape(table.head[k]), "</th>");
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k)
      out += k == 0 ? "<th scope=\"row\">" + html_escape(row[k]) + "</th>" : cell(k, row[k]);
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

}  // namespace vernier::detail
