// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A file of comma-separated values: its columns by name, its cells as numbers.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/types.hpp"
#include "vernier/data/csv_format.hpp"
#include "vernier/data/detail/csv_columns.hpp"
#include "vernier/data/detail/text_lines.hpp"
#include "vernier/data/row_origin.hpp"

namespace vernier::detail {

/// A column of a file.
struct CsvColumn {
  std::string name;  ///< as in the header
  std::size_t index;
  const Quantity* quantity;
  double factor;  ///< to m, rad, s or deg C
};

/// The lines of a file, its numbers by column name.
class CsvTable {
 public:
  /// @throws DataError on a file without header, with another separator, or with a known column twice
  /// @throws std::invalid_argument on a format that cannot be
  VERNIER_API CsvTable(const std::string& path, const CsvFormat& format);

  /// Throws a DataError about the header.
  template <class... Parts>
  [[noreturn]] void fail_in_header(const Parts&... parts) const {
    throw DataError(message(file_, ", line ", header_line_, ": ", parts...));
  }
  /// Throws a DataError about a value.
  template <class... Parts>
  [[noreturn]] void fail_in_row(Index row, const CsvColumn& column, const Parts&... parts) const {
    throw DataError(place(lines_[static_cast<std::size_t>(row)].number, column.name) + message(parts...));
  }

  /// Where its rows stand.
  VERNIER_API RowOrigin origin() const;
  /// Names of the columns.
  const std::vector<std::string_view>& header() const { return header_; }
  /// Its rows.
  const std::vector<TextLine>& lines() const { return lines_; }
  /// The cells of a line, as many as the header has.
  VERNIER_API std::vector<std::string_view> fields_of(const TextLine& line) const;

  /// The column of a name and one of its units; empty where there is none.
  VERNIER_API std::optional<CsvColumn> find(std::string_view stem, const Quantity& quantity) const;
  /// A column that must be there: its absence is an error that lists the columns present.
  VERNIER_API CsvColumn require_column(std::string_view stem, const Quantity& quantity) const;

  /// The text of a column as it is, one entry a row.
  VERNIER_API std::vector<std::string> texts(const CsvColumn& column) const;
  /// All values of some columns, rows x columns, in m, rad, s and deg C; at least one row.
  VERNIER_API MatrixX numbers(const std::vector<CsvColumn>& columns) const;
  /// A column of numbers, NaN where a cell is empty.
  VERNIER_API VectorX optional_numbers(const CsvColumn& column) const;

  /// Says something of a file that is read all the same.
  VERNIER_API void remark(const std::string& what) const;
  /// Says which columns nobody has looked for, with the names that may have been meant.
  /// @throws DataError on such a name, where nobody listens
  VERNIER_API void remark_unread() const;

 private:
  VERNIER_API void require_separated(std::string_view header) const;
  VERNIER_API void rename_columns();
  VERNIER_API std::string place(std::size_t line, std::string_view column) const;
  VERNIER_API double value(std::string_view cell, std::size_t line, const CsvColumn& column) const;
  VERNIER_API std::vector<std::string_view> cells(const TextLine& line) const;

  std::string file_, content_;
  CsvFormat format_;
  std::vector<std::string_view> header_{};
  std::size_t header_line_ = 0;  // counted from 1
  std::vector<TextLine> lines_{};
  mutable std::vector<bool> read_{};  // columns that were found
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/csv_table.ipp"
#endif
