// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Tables of points, as the programs of laser trackers and other measuring systems export them.

#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/data_error.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// How a table of points is written. Nothing of it is guessed from the file.
struct PointTableFormat {
  std::vector<std::string> columns{"name", "x", "y", "z"};  ///< in their order; `name` may be missing, other words are
                                                            ///< columns that are skipped
  char separator = ',';    ///< between cells; a blank stands for any number of blanks and tabs
  char decimal = '.';      ///< the decimal point
  std::string comment{};   ///< lines that begin with it are skipped; empty: none are
  Index header_lines = 0;  ///< lines at the beginning that are skipped
  double unit = 1e-3;      ///< of x, y, z [m]

  /// ASCII points of SpatialAnalyzer: collection, group and name of each target, then x, y, z, by blanks; header lines
  /// begin with `//`.
  /// @param unit of the file, that of the job it was exported from [m]
  VERNIER_API static PointTableFormat spatial_analyzer(double unit);
};

/// A unit of lengths by its name, one of um, mm, cm, m, in, ft [m].
/// @throws std::invalid_argument for another name, with those there are
VERNIER_API double length_unit(std::string_view name);

/// Measured points in the order of their file.
struct PointTable {
  std::string file{};                ///< its name
  std::vector<std::string> names{};  ///< of the points; empty where the format has no column `name`
  std::vector<Index> lines{};        ///< number of the line of each, from 1
  PointRows points{};                ///< n x 3 [m], in the frame of the file
};

/// Reads a table of points of at most 256 MiB, 1,000 columns and a million rows. Blank lines, lines that end
/// with CRLF or CR, a byte-order mark and quotation marks around a cell are accepted.
/// @throws DataError naming file, line and column
/// @throws std::invalid_argument on a format that cannot be: without x, y and z, or ambiguous
VERNIER_API PointTable read_point_table(const std::string& path, const PointTableFormat& format);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/point_table.ipp"
#endif
