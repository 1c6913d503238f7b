// SPDX-License-Identifier: BSD-3-Clause
#include "csv_options.hpp"

#include <fmt/format.h>

#include <cctype>
#include <string_view>

#include "vernier/core/check.hpp"
#include "vernier/data/detail/csv_columns.hpp"
#include "vernier/data/detail/pose_values.hpp"
#include "vernier/io/json.hpp"

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
  program
      .add_option(("--" + of + "columns").c_str(), columns,
                  "other names of columns in " + what + ", ours first: q1_deg=A1,q2_deg=A2,x_mm=X", "OURS=THEIRS,..")
      .delimiter(',');
}

void CsvOptions::add_euler_to(Program& program) {
  program.add_option("--euler", euler,
                     "orientations are Euler angles about these axes, in the order of turning: ZYX (each about the "
                     "turned axes) or xyz (about fixed axes); columns rx_deg, ry_deg, rz_deg (about x, y and z) or "
                     "euler1_deg .. euler3_deg (in that order). Without it rx_rad .. are a rotation vector",
                     "AXES");
}

vernier::CsvFormat CsvOptions::format() const {
  vernier::CsvFormat out;
  if (!euler.empty() && !vernier::detail::euler_axes(euler))
    throw UsageError("--euler takes three axes, such as ZYX (turned axes) or xyz (fixed axes); not '" +
                     vernier::detail::quotable(euler) + "'");
  out.euler = euler;
  if (!separator.empty()) out.separator = one_character(separator, "--" + of_ + "separator");
  if (!decimal.empty()) out.decimal = one_character(decimal, "--" + of_ + "decimal");
  if (out.decimal != '.' && out.decimal != ',') throw UsageError("--" + of_ + "decimal is . or ,");
  if (out.separator == out.decimal)
    throw UsageError(fmt::format("--{0}separator and --{0}decimal are both '{1}'", of_, out.decimal));
  if (std::string_view("+-_.\"").find(out.separator) != std::string_view::npos ||
      std::isalnum(static_cast<unsigned char>(out.separator)) != 0)
    throw UsageError(fmt::format("--{}separator: '{}' cannot be one", of_, out.separator));
  for (const std::string& one : columns) {
    const std::size_t equals = one.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == one.size())
      throw UsageError(fmt::format("--{}columns takes our name, = and the file's, as q1_deg=A1; not '{}'", of_,
                                   vernier::detail::quotable(one)));
    const std::string ours = one.substr(0, equals);
    if (!vernier::detail::known_column(ours))
      throw UsageError(fmt::format("--{}columns: no file has a column '{}'{}", of_, vernier::detail::quotable(ours),
                                   vernier::detail::nearest_column(ours).empty()
                                       ? std::string()
                                       : "; is it " + vernier::detail::nearest_column(ours) + "?"));
    out.columns.emplace_back(ours, one.substr(equals + 1));
  }
  out.remark = [](const std::string& line) { fmt::print("{}\n", line); };
  out.controller = controller;
  return out;
}

}  // namespace support
