// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "vernier/core/sha256.hpp"
#include "vernier/data/detail/csv_table.hpp"

namespace vernier::detail {

VERNIER_LOCAL void require_format(const CsvFormat& format) {
  const auto word = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  demand(!word(format.separator) && std::string_view("+-_.\"\r\n").find(format.separator) == std::string_view::npos,
         "CsvFormat: ", name_of_separator(format.separator), " cannot be a separator");
  demand(format.decimal == '.' || format.decimal == ',', "CsvFormat: ", name_of_separator(format.decimal),
         " cannot be a decimal point");
  demand(format.separator != format.decimal, "CsvFormat: '", format.decimal,
         "' is both the separator and the decimal point");
  for (const auto& [ours, theirs] : format.columns)
    demand(known_column(ours), "CsvFormat: '", printable(theirs), "' cannot stand for ", printable(ours),
           ", which is no column of any file");
}

/// A separator as the programs' options take it.
VERNIER_LOCAL std::string option_value(char separator) {
  return separator == ' ' ? "space" : separator == '\t' ? "tab" : name_of_separator(separator);
}

VERNIER_IMPL CsvTable::CsvTable(const std::string& path, const CsvFormat& format) : file_(path), format_(format) {
  require_format(format);
  content_ = text_of(path);
  lines_ = text_lines(file_, content_);
  std::size_t first = 0;
  if (!lines_.empty() && lines_[0].text.starts_with("sep=") && lines_[0].text.size() == 5) {  // a line of Excel
    if (const char said = lines_[0].text[4]; said != format_.separator)
      throw DataError(message(file_, ", line ", lines_[0].number, ": columns are separated by ",
                              name_of_separator(said), ", not ", name_of_separator(format_.separator),
                              "; state that: --separator ", option_value(said), " (CsvFormat)"));
    first = 1;
  }
  if (lines_.size() == first) throw DataError(file_ + ": empty, a header line with column names is missing");
  header_line_ = lines_[first].number;
  const std::string_view names = lines_[first].text;
  header_ = cells(lines_[first]);
  lines_.erase(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  if (header_.size() == 1) require_separated(names);
  rename_columns();
  read_.assign(header_.size(), false);
  std::vector<std::string_view> sorted = header_;
  std::sort(sorted.begin(), sorted.end());
  for (auto at = std::adjacent_find(sorted.begin(), sorted.end()); at != sorted.end();
       at = std::adjacent_find(at + 1, sorted.end()))
    if (known_column(*at)) fail_in_header("column ", *at, " is there twice");
}

/// Calls columns as we do.
VERNIER_IMPL void CsvTable::rename_columns() {
  const std::vector<std::string_view> named = header_;  // so that two columns can change their names
  for (const auto& [ours, theirs] : format_.columns) {
    const auto found = std::find(named.begin(), named.end(), theirs);
    if (found != named.end())
      header_[static_cast<std::size_t>(found - named.begin())] = ours;
    else if (format_.remark)
      remark(message(": no column '", printable(theirs), "' for ", ours));
    else
      fail_in_header("no column '", printable(theirs), "' for ", ours);
  }
}

/// A header of a single column, which another separator would take apart.
VERNIER_IMPL void CsvTable::require_separated(std::string_view header) const {
  for (const char other : {';', '\t', ',', '|', ' '}) {
    if (other == format_.separator || trimmed(header).find(other) == std::string_view::npos) continue;
    const auto where = [&] { return message(file_, ", line ", header_line_, ": "); };
    const auto names = cells_of(header, other, where);
    const auto ours = [](std::string_view name) { return known_column(name) || !nearest_column(name).empty(); };
    if (std::none_of(names.begin(), names.end(), ours)) continue;
    bool comma = false;
    if (format_.decimal == '.' && other != ',' && !lines_.empty())
      for (const std::string_view cell : cells_of(lines_[0].text, other, where))
        comma = comma || (cell.find(',') != std::string_view::npos &&
                          cell.find_first_not_of("0123456789,+-eE") == std::string_view::npos);
    fail_in_header("columns are separated by ", name_of_separator(other), ", not ",
                   name_of_separator(format_.separator), "; state that: --separator ", option_value(other),
                   comma ? " --decimal ','" : "", " (CsvFormat)");
  }
}

VERNIER_IMPL RowOrigin CsvTable::origin() const {
  std::vector<Index> lines;
  for (const TextLine& line : lines_) lines.push_back(static_cast<Index>(line.number));
  return RowOrigin::of(file_, std::move(lines), sha256(content_));
}

VERNIER_IMPL std::vector<std::string_view> CsvTable::cells(const TextLine& line) const {
  const auto where = [&] { return message(file_, ", line ", line.number, ": "); };
  auto out = cells_of(line.text, format_.separator, where);
  if (out.size() > most_columns) throw DataError(message(where(), "has more than ", most_columns, " values"));
  return out;
}

VERNIER_IMPL std::vector<std::string_view> CsvTable::fields_of(const TextLine& line) const {
  auto out = cells(line);
  if (out.size() == header_.size()) return out;
  const bool doubled = format_.separator == ',' && out.size() == 2 * header_.size();
  throw DataError(message(file_, ", line ", line.number, ": ", out.size(), " values, the header has ", header_.size(),
                          doubled ? "; decimal commas need another separator, see --separator and --decimal" : ""));
}

VERNIER_IMPL std::optional<CsvColumn> CsvTable::find(std::string_view stem, const Quantity& quantity) const {
  std::optional<CsvColumn> found;
  for (const auto& [unit, factor] : quantity.units)
    for (std::size_t i = 0; i < header_.size(); ++i) {
      if (header_[i].size() != stem.size() + unit.size() || !header_[i].starts_with(stem) ||
          !header_[i].ends_with(unit))
        continue;
      if (found) fail_in_header("columns ", found->name, " and ", header_[i], " both give ", stem);
      found = CsvColumn{std::string(header_[i]), i, &quantity, factor};
      read_[i] = true;
    }
  return found;
}

/// Whether a controller may call the joint of a column so: J1, joint_1, axis1 or A1 for the stem q1.
VERNIER_LOCAL bool names_joint(std::string_view name, std::string_view stem) {
  std::string plain(name);
  for (char& c : plain)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (!stem.starts_with('q')) return false;
  for (const char* word : {"joint", "axis", "j", "a"})
    for (const char* between : {"", "_", " "})
      if (plain == message(word, between, stem.substr(1))) return true;
  return false;
}

VERNIER_IMPL CsvColumn CsvTable::require_column(std::string_view stem, const Quantity& quantity) const {
  if (auto column = find(stem, quantity)) return *column;
  std::string present, hint;
  for (std::size_t i = 0; i < header_.size() && i < 12; ++i) present += (i ? ", " : "") + printable(header_[i]);
  if (header_.size() > 12) present += ", ...";
  for (const std::string_view name : header_)
    if (const std::string known = nearest_column(name); known.starts_with(stem) && hint.empty())
      hint = message("; is '", printable(name), "' ", known, "?");
  const auto name = [&](std::size_t unit) { return message(stem, quantity.units[unit].first); };
  for (const std::string_view other : header_)
    if (hint.empty() && names_joint(other, stem))
      hint = message("; if that is ", printable(other), ", state --columns '", name(0), "=", printable(other), "' or '",
                     name(1), "=", printable(other), "' (CsvFormat)");
  throw DataError(message(file_, ", line ", header_line_, ": no column ", name(0),
                          quantity.units.size() > 1 ? " or " + name(1) : std::string(), " in the header (", present,
                          ")", hint));
}

VERNIER_IMPL std::vector<std::string> CsvTable::texts(const CsvColumn& column) const {
  std::vector<std::string> out;
  for (const TextLine& line : lines_) out.emplace_back(fields_of(line)[column.index]);
  return out;
}

VERNIER_IMPL MatrixX CsvTable::numbers(const std::vector<CsvColumn>& columns) const {
  if (lines_.empty()) throw DataError(file_ + ": a header, but no rows of data");
  MatrixX out(static_cast<Index>(lines_.size()), static_cast<Index>(columns.size()));
  for (std::size_t row = 0; row < lines_.size(); ++row) {
    const auto fields = fields_of(lines_[row]);
    for (std::size_t k = 0; k < columns.size(); ++k)
      out(static_cast<Index>(row), static_cast<Index>(k)) =
          value(fields[columns[k].index], lines_[row].number, columns[k]);
  }
  return out;
}

VERNIER_IMPL VectorX CsvTable::optional_numbers(const CsvColumn& column) const {
  VectorX out = VectorX::Constant(static_cast<Index>(lines_.size()), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < lines_.size(); ++row) {
    const std::string_view cell = fields_of(lines_[row])[column.index];
    if (!cell.empty()) out(static_cast<Index>(row)) = value(cell, lines_[row].number, column);
  }
  return out;
}

VERNIER_IMPL std::string CsvTable::place(std::size_t line, std::string_view column) const {
  return message(file_, ", line ", line, ", column ", column, ": ");
}

VERNIER_IMPL double CsvTable::value(std::string_view cell, std::size_t line, const CsvColumn& column) const {
  const auto where = [&] { return place(line, column.name); };
  const auto fail = [&](std::string_view what) {
    throw DataError(message(where(), "'", printable(cell), "' is ", what));
  };
  const Quantity& quantity = *column.quantity;
  if (quantity.units.data() == time_units.data() &&
      (cell.find_first_of(":/") != std::string_view::npos ||
       (std::count(cell.begin(), cell.end(), '-') > 1 && cell.find_first_of("eE") == std::string_view::npos)))
    fail("a date or a time of day; seconds are needed, Unix time or any other");
  const double out = number_in(cell, format_.decimal, where) * column.factor;
  if (!(out > quantity.smallest && out < quantity.largest)) fail(quantity.otherwise);
  return out;
}

VERNIER_IMPL void CsvTable::remark(const std::string& what) const {
  if (format_.remark) format_.remark(file_ + what);
}

VERNIER_IMPL void CsvTable::remark_unread() const {
  constexpr std::size_t most = 12;
  std::size_t count = 0;
  std::string names;
  for (std::size_t i = 0; i < header_.size(); ++i) {
    if (read_[i] || header_[i].empty() || needs_no_reader(header_[i])) continue;
    const std::string known = nearest_column(header_[i]);
    if (!format_.remark && !known.empty())
      fail_in_header("column '", printable(header_[i]), "' is not known; is it ", known,
                     "? Rename it, or take CsvFormat::remark, and it is not read");
    if (++count <= most)
      names += (count > 1 ? ", " : "") + printable(header_[i]) + (known.empty() ? "" : " (" + known + "?)");
  }
  if (count == 0) return;
  remark(message(": columns that are not read: ", names, count > most ? message(", and ", count - most, " more") : ""));
}

}  // namespace vernier::detail
