// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The options that say how the CSV files of a command line are written.

#include <string>
#include <vector>

#include "cli.hpp"
#include "vernier/core/controller_map.hpp"
#include "vernier/data/csv_format.hpp"

namespace support {

/// A character of an option: itself, or tab or space.
/// @param option its name, for the message
/// @throws UsageError for more than one character
char one_character(const std::string& text, const std::string& option);

/// How the CSV files of a command line are written.
struct CsvOptions {
  std::string separator{}, decimal{};   ///< empty: a comma, and a point
  std::vector<std::string> columns{};   ///< columns that files call otherwise, `ours=theirs`
  std::string euler{};                  ///< axes of Euler angles, see `CsvFormat`; empty: there are none
  vernier::ControllerMap controller{};  ///< whose joint values the files have; programs take it from the arm

  /// Adds --separator, --decimal and --columns to a command line.
  /// @param of   "" or what their names begin with, e.g. "joints-"
  /// @param what the files, for the help
  void add_to(Program& program, const std::string& of = "", const std::string& what = "CSV files that are read");
  /// Adds --euler, for files with orientations.
  void add_euler_to(Program& program);
  /// For readers; what they remark is printed.
  /// @throws UsageError for a format that cannot be
  vernier::CsvFormat format() const;

 private:
  std::string of_{};
};

}  // namespace support
