// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/point_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/data/detail/csv_columns.hpp"
#include "vernier/data/detail/text_lines.hpp"

namespace vernier {

namespace detail {

/// The index of a column that may be there once; -1 where it is not.
VERNIER_LOCAL Index column_index(const std::vector<std::string>& columns, std::string_view name) {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) return -1;
  demand(std::find(found + 1, columns.end(), name) == columns.end(), "PointTableFormat: column ", name,
         " is there twice");
  return found - columns.begin();
}

}  // namespace detail

VERNIER_IMPL PointTableFormat PointTableFormat::spatial_analyzer(double unit) {
  return {.columns = {"collection", "group", "name", "x", "y", "z"},
          .separator = ' ',
          .decimal = '.',
          .comment = "//",
          .header_lines = 0,
          .unit = unit};
}

VERNIER_IMPL double length_unit(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, double>, 6> units{
      {{"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}, {"in", 0.0254}, {"ft", 0.3048}}};
  for (const auto& [known, size] : units)
    if (known == name) return size;
  detail::throw_invalid_argument({detail::MessagePart(
      message("no unit of lengths is called '", detail::printable(name), "'; there are um, mm, cm, m, in, ft"))});
}

VERNIER_IMPL PointTable read_point_table(const std::string& path, const PointTableFormat& format) {
  const std::size_t width = format.columns.size();
  const Index name = detail::column_index(format.columns, "name");
  std::array<Index, 3> axes{};
  for (std::size_t k = 0; k < 3; ++k) {
    axes[k] = detail::column_index(format.columns, std::array{"x", "y", "z"}[k]);
    demand(axes[k] >= 0, "PointTableFormat: no column ", std::array{"x", "y", "z"}[k]);
  }
  demand(format.separator != format.decimal, "PointTableFormat: '", format.decimal,
         "' is both the separator and the decimal point");
  demand(format.unit > 0, "PointTableFormat: unit is ", format.unit, ", must be positive");

  PointTable out{path, {}, {}, PointRows(0, 3)};
  const std::string content = detail::text_of(path);
  std::vector<double> values;
  for (const detail::TextLine& line : detail::text_lines(path, content)) {
    if (static_cast<Index>(line.number) <= format.header_lines) continue;
    if (!format.comment.empty() && detail::trimmed(line.text).starts_with(format.comment)) continue;
    const auto cells =
        detail::cells_of(line.text, format.separator, [&] { return message(path, ", line ", line.number, ": "); });
    if (cells.size() != width)
      throw DataError(message(
          path, ", line ", line.number, ": ",
          cells.size() > detail::most_columns ? message("more than ", detail::most_columns) : message(cells.size()),
          cells.size() == 1 ? " cell, " : " cells, ", width, " columns are declared, separated by ",
          detail::name_of_separator(format.separator), ": '", detail::printable(detail::trimmed(line.text)), "'"));
    for (const Index axis : axes) {
      const auto at = static_cast<std::size_t>(axis);
      const auto where = [&] { return message(path, ", line ", line.number, ", column ", format.columns[at], ": "); };
      values.push_back(detail::number_in(cells[at], format.decimal, where) * format.unit);
      if (!(std::abs(values.back()) < detail::quantities::coordinate.largest))
        throw DataError(
            message(where(), "'", detail::printable(cells[at]), "' is ", detail::quantities::coordinate.otherwise));
    }
    if (name >= 0) {
      const std::string_view cell = cells[static_cast<std::size_t>(name)];
      if (cell.empty()) throw DataError(message(path, ", line ", line.number, ", column name: no value"));
      out.names.emplace_back(cell);
    }
    out.lines.push_back(static_cast<Index>(line.number));
  }
  if (out.lines.empty()) throw DataError(message(path, ": no points"));
  out.points.resize(static_cast<Index>(out.lines.size()), 3);
  for (Index i = 0; i < out.points.rows(); ++i)
    for (Index c = 0; c < 3; ++c) out.points(i, c) = values[static_cast<std::size_t>(3 * i + c)];
  return out;
}

}  // namespace vernier
