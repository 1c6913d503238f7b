// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How files of comma-separated values are written.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/controller_map.hpp"

namespace vernier {

/// How a CSV file is written. Nothing of it is guessed from the file: another one is refused, and the message names
/// what to state.
struct CsvFormat {
  char separator = ',';  ///< between cells; a blank stands for any number of blanks and tabs
  char decimal = '.';    ///< the decimal point
  /// Takes what is said of a file that is read all the same, a line each: columns that are not read, times that go
  /// back. Empty: nobody is told, and a file with a column that is not read, but differs from a known one by case, by
  /// blanks and brackets or by its unit alone, is refused.
  std::function<void(const std::string&)> remark{};
  /// Orientations are Euler angles about these three axes, in the order of turning: capital letters for axes that turn
  /// along ("ZYX"), small ones for axes that stay ("xyz"). Columns rx, ry and rz are the angles about x, y and z, or
  /// euler1, euler2 and euler3 those in the order of turning, each with a unit. Empty: there are none.
  std::string euler{};
  /// Joint values of the file are those of this controller. Readers return those of the chain.
  ControllerMap controller{};
  /// Columns that the file calls otherwise: our name (`q1_deg`), then the file's (`A1`). A file without the second is
  /// remarked upon; if nobody listens, it is refused.
  std::vector<std::pair<std::string, std::string>> columns{};
};

}  // namespace vernier
