// SPDX-License-Identifier: BSD-3-Clause
#include "csv_options.hpp"

#include <fmt/format.h>

#include <cctype>
#include <string_view>

namespace support {

char one_character(const std::string& text, const std::string& option) {
  if (text == "tab") return '\t';
  if (text == "space") return ' ';
  if (text.size() != 1) throw UsageError(option + " takes one character, or tab or space");
  return text.front();
}

void CsvOptions::add_to(Program& program, const std::string& of, const std::string& what) {
  of_ = of;
  program.add_option(("--" + of + "separator").c_str(), separator,
                     "between the columns of " + what +
                         ": a character, tab, or space for any number of blanks; a "
                         "comma without it",
                     "C");
  program.add_option(("--" + of + "decimal").c_str(), decimal, "decimal point of " + what + "; . without it", "C");
}

vernier::CsvFormat CsvOptions::format() const {
  vernier::CsvFormat out;
  if (!separator.empty()) out.separator = one_character(separator, "--" + of_ + "separator");
  if (!decimal.empty()) out.decimal = one_character(decimal, "--" + of_ + "decimal");
  if (out.decimal != '.' && out.decimal != ',') throw UsageError("--" + of_ + "decimal is . or ,");
  if (out.separator == out.decimal)
    throw UsageError(fmt::format("--{0}separator and --{0}decimal are both '{1}'", of_, out.decimal));
  if (std::string_view("+-_.\"").find(out.separator) != std::string_view::npos ||
      std::isalnum(static_cast<unsigned char>(out.separator)) != 0)
    throw UsageError(fmt::format("--{}separator: '{}' cannot be one", of_, out.separator));
  out.remark = [](const std::string& line) { fmt::print("{}\n", line); };
  out.controller = controller;
  return out;
}

}  // namespace support
