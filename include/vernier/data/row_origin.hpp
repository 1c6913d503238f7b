// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where the rows of a set of measurements stand in files, so that messages can name file and line.

#include <span>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Files and lines of n rows; empty for rows that are from no file.
struct RowOrigin {
  std::vector<std::string> files{};   ///< names of the files
  std::vector<int> file{};            ///< of each row, which of them
  std::vector<Index> line{};          ///< of each row, its line in that file, from 1
  std::vector<std::string> hashes{};  ///< of each file, SHA-256 of the bytes that were read, see `sha256`

  /// Rows that follow each other in one file.
  /// @param name  of the file
  /// @param lines of the rows, from 1
  /// @param hash  of the file; empty where it is not known
  VERNIER_API static RowOrigin of(std::string name, std::vector<Index> lines, std::string hash = {});

  /// Whether nothing is known.
  bool empty() const { return line.empty(); }
  /// A row for a message: "measured.csv, line 57"; "row 55" (from 0) where its file is not known.
  VERNIER_API std::string where(Index row) const;
  /// Several rows for a message: "measured.csv, lines 3, 5 and 8"; "rows 1, 3 and 6" (from 0) where files are not
  /// known; ten of them at most, then their number.
  VERNIER_API std::string where(const std::vector<Index>& of_rows) const;
  /// The named rows, in the given order.
  VERNIER_API RowOrigin rows(std::span<const Index> indices) const;
  /// Appends rows of other files; empty where either of both is not known.
  /// @param other of the rows that are appended
  /// @param size  number of rows of this
  VERNIER_API void append(const RowOrigin& other, Index size);
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/row_origin.ipp"
#endif
