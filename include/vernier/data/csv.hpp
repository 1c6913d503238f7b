#pragma once

/// @file
/// Reading and writing measured poses and joint targets as comma-separated values, units in the column names.

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/atomic_file.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"

namespace vernier {

/// A file that does not hold what it should; the message names file, line and column.
class DataError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

namespace detail {

/// A column asked for by its stem, with the unit found in its name.
struct CsvColumn {
  std::string name;  ///< as in the header
  std::size_t index;
  double factor;  ///< to m or rad
};

/// The lines of a file as views of numbers by column name. Quotes are not part of the format.
class CsvTable {
 public:
  explicit CsvTable(const std::filesystem::path& path) : file_(path.string()) {
    try {
      content_ = read_file(path);
    } catch (const std::invalid_argument& e) {
      throw DataError(e.what());
    }
    std::string_view rest = content_;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    std::size_t number = 0;
    while (!rest.empty()) {
      const std::size_t end = rest.find_first_of("\n");
      std::string_view line = rest.substr(0, end);
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
      ++number;
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
      if (line.find('\0') != std::string_view::npos)
        throw DataError(message(file_, ", line ", number, ": binary data, not text"));
      if (header_.empty()) {
        header_ = cells(line);
        header_line_ = number;
      } else {
        lines_.push_back({number, line});
      }
    }
    if (header_.empty()) throw DataError(message(file_, ": empty, a header line with column names is missing"));
  }

  const std::string& file() const { return file_; }
  std::size_t header_line() const { return header_line_; }
  std::size_t size() const { return lines_.size(); }
  /// Number in the file of a row of data.
  std::size_t line(Index row) const { return lines_[static_cast<std::size_t>(row)].number; }

  /// The column `stem` + `_unit` for the first unit that is there; empty where none is.
  std::optional<CsvColumn> find(std::string_view stem, bool length) const {
    constexpr std::array<std::pair<std::string_view, double>, 3> lengths{{{"_mm", 1e-3}, {"_m", 1.0}, {"_um", 1e-6}}};
    constexpr std::array<std::pair<std::string_view, double>, 3> angles{
        {{"_rad", 1.0}, {"_deg", std::numbers::pi / 180}, {"_mrad", 1e-3}}};
    std::optional<CsvColumn> found;
    for (const auto& [unit, factor] : length ? lengths : angles)
      for (std::size_t i = 0; i < header_.size(); ++i) {
        if (header_[i].size() != stem.size() + unit.size() || !header_[i].starts_with(stem) ||
            !header_[i].ends_with(unit))
          continue;
        if (found)
          throw DataError(message(file_, ", line ", header_line_, ": columns ", found->name, " and ", header_[i],
                                  " both give ", stem));
        found = CsvColumn{std::string(header_[i]), i, factor};
      }
    return found;
  }

  /// As `find`, but its absence is an error that lists what is there.
  CsvColumn demand(std::string_view stem, bool length) const {
    if (auto column = find(stem, length)) return *column;
    std::string there;
    for (std::size_t i = 0; i < header_.size() && i < 12; ++i) there += (i ? ", " : "") + printable(header_[i]);
    if (header_.size() > 12) there += ", ...";
    throw DataError(message(file_, ": no column ", stem, length ? "_mm or " : "_rad or ", stem, length ? "_m" : "_deg",
                            " in the header (", there, ")"));
  }

  /// All values of some columns, rows x columns, in m and rad.
  MatrixX numbers(const std::vector<CsvColumn>& columns) const {
    MatrixX out(static_cast<Index>(lines_.size()), static_cast<Index>(columns.size()));
    for (std::size_t row = 0; row < lines_.size(); ++row) {
      const auto& [number, line] = lines_[row];
      const auto fields = cells(line);
      if (fields.size() != header_.size())
        throw DataError(
            message(file_, ", line ", number, ": ", fields.size(), " values, the header has ", header_.size()));
      for (std::size_t k = 0; k < columns.size(); ++k)
        out(static_cast<Index>(row), static_cast<Index>(k)) =
            value(fields[columns[k].index], number, columns[k].name) * columns[k].factor;
    }
    return out;
  }

 private:
  static std::vector<std::string_view> cells(std::string_view line) {
    std::vector<std::string_view> out;
    for (;;) {
      const std::size_t comma = line.find(',');
      std::string_view cell = line.substr(0, comma);
      const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
      out.push_back(first == std::string_view::npos ? std::string_view{} : cell.substr(first, last - first + 1));
      if (comma == std::string_view::npos) return out;
      line.remove_prefix(comma + 1);
    }
  }

  static std::string printable(std::string_view cell) {
    std::string out;
    for (const char c : cell.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (cell.size() > 40 ? "..." : "");
  }

  double value(std::string_view cell, std::size_t line, const std::string& column) const {
    const auto where = [&] { return message(file_, ", line ", line, ", column ", column, ": "); };
    if (cell.empty()) throw DataError(where() + "no value");
    std::string_view digits = cell;
    if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
    double out = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
    if (error == std::errc::result_out_of_range) throw DataError(where() + "'" + printable(cell) + "' is out of range");
    if (error != std::errc{} || end != digits.data() + digits.size())
      throw DataError(where() + "'" + printable(cell) + "' is not a number");
    if (!std::isfinite(out)) throw DataError(where() + "'" + printable(cell) + "' is not finite");
    if (std::abs(out) > 1e9) throw DataError(where() + "'" + printable(cell) + "' is beyond any joint or length (1e9)");
    return out;
  }

  struct Line {
    std::size_t number;
    std::string_view text;
  };
  std::string file_, content_;
  std::vector<std::string_view> header_;
  std::size_t header_line_ = 0;  // counted from 1
  std::vector<Line> lines_;
};

/// Columns q1 .. qN: angles, or lengths for prismatic joints. Refuses a file of more joints than N.
template <int N>
std::vector<CsvColumn> joint_columns(const CsvTable& table) {
  std::vector<CsvColumn> columns;
  for (int i = 1; i <= N; ++i) {
    const std::string stem = message("q", i);
    const auto length = table.find(stem, true);
    const auto angle = table.find(stem, false);
    if (length && angle)
      throw DataError(message(table.file(), ", line ", table.header_line(), ": columns ", length->name, " and ",
                              angle->name, " both give ", stem));
    columns.push_back(length ? *length : table.demand(stem, false));
  }
  const std::string surplus = message("q", N + 1);
  for (const bool length : {false, true})
    if (const auto next = table.find(surplus, length))
      throw DataError(message(table.file(), ", line ", table.header_line(), ": column ", next->name,
                              ", but the robot has ", N, " joints"));
  return columns;
}

}  // namespace detail

/// Measured poses from a CSV file: columns q1_rad .. qN_rad (or _deg; _mm or _m for prismatic joints), x_mm, y_mm, z_mm
/// (or _m), optionally rx_rad, ry_rad, rz_rad (rotation vector, or _deg). Any column order; other columns are ignored;
/// blank lines, CRLF and a byte-order mark are accepted.
/// @throws DataError naming file, line and column
template <int N>
Dataset<N> read_dataset(const std::filesystem::path& path) {
  const detail::CsvTable table(path);
  std::vector<detail::CsvColumn> columns = detail::joint_columns<N>(table);
  for (const char* axis : {"x", "y", "z"}) columns.push_back(table.demand(axis, true));
  const bool oriented = table.find("rx", false) || table.find("ry", false) || table.find("rz", false);
  if (oriented)
    for (const char* axis : {"rx", "ry", "rz"}) columns.push_back(table.demand(axis, false));
  const MatrixX values = table.numbers(columns);
  if (values.rows() == 0) throw DataError(message(table.file(), ": a header, but no rows of data"));
  return Dataset<N>(values.leftCols<N>(), values.middleCols<3>(N),
                    oriented ? PointRows(values.rightCols<3>()) : PointRows(0, 3));
}

/// Measured distances from a CSV file: columns q1 .. qN as in `read_dataset`, and distance_mm (or _m, _um).
/// @throws DataError naming file, line and column
template <int N>
Distances<N> read_distances(const std::filesystem::path& path) {
  const detail::CsvTable table(path);
  std::vector<detail::CsvColumn> columns = detail::joint_columns<N>(table);
  columns.push_back(table.demand("distance", true));
  const MatrixX values = table.numbers(columns);
  if (values.rows() == 0) throw DataError(message(table.file(), ": a header, but no rows of data"));
  for (Index i = 0; i < values.rows(); ++i)
    if (!(values(i, N) > 0))
      throw DataError(message(table.file(), ", line ", table.line(i), ", column ", columns.back().name,
                              ": a distance must be positive"));
  return Distances<N>(values.leftCols<N>(), values.col(N));
}

/// Joint rows from a CSV file: columns as in `read_dataset`, the q columns alone.
/// @throws DataError naming file, line and column
template <int N>
JointRows<N> read_joints(const std::filesystem::path& path) {
  const detail::CsvTable table(path);
  const MatrixX values = table.numbers(detail::joint_columns<N>(table));
  if (values.rows() == 0) throw DataError(message(table.file(), ": a header, but no rows of data"));
  return values;
}

/// Writes measured poses as `read_dataset` reads them, joints in rad, positions in mm, in digits that read back exactly
/// (positions to the last bit or two, for the change of unit). Whole or not at all.
/// @throws std::runtime_error when the file cannot be written
template <int N>
void write_dataset(const std::filesystem::path& path, const Dataset<N>& data) {
  std::string out;
  for (int j = 1; j <= N; ++j) out += message("q", j, "_rad,");
  out += data.has_orientations() ? "x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n" : "x_mm,y_mm,z_mm\n";
  for (Index i = 0; i < data.size(); ++i) {
    for (int j = 0; j < N; ++j) out += message(data.joints()(i, j), ',');
    for (int j = 0; j < 3; ++j)
      out += message(data.positions()(i, j) * 1e3, j < 2 || data.has_orientations() ? "," : "\n");
    if (data.has_orientations())
      for (int j = 0; j < 3; ++j) out += message(data.orientations()(i, j), j < 2 ? ',' : '\n');
  }
  write_file(path, out);
}

}  // namespace vernier
