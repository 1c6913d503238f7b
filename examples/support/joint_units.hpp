// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Units of the joint columns that programs write.

#include <numbers>
#include <span>
#include <string>

#include "cli.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace support {

/// Joint columns in radians and metres, or as pendants show them: in degrees and millimetres.
struct JointUnits {
  bool degrees = false;

  /// Adds --degrees to a command line.
  Option add_to(Program& program) {
    return program.add_flag(
        "--degrees", degrees,
        "joints of --out in degrees (q1_deg) and, of prismatic joints, millimetres (q1_mm); without it in "
        "radians and metres");
  }
  /// `q1_rad,q2_rad,..`, with a comma at the end.
  std::string header(std::span<const vernier::JointType> types) const {
    std::string out;
    for (std::size_t j = 0; j < types.size(); ++j)
      out += vernier::message("q", j + 1,
                              types[j] == vernier::JointType::revolute ? degrees ? "_deg," : "_rad,"
                              : degrees                                ? "_mm,"
                                                                       : "_m,");
    return out;
  }
  /// Values of one row, with a comma after each.
  /// @param joints as many as types [rad, m]
  std::string cells(std::span<const double> joints, std::span<const vernier::JointType> types) const {
    std::string out;
    for (std::size_t j = 0; j < types.size(); ++j) {
      const double factor = !degrees ? 1 : types[j] == vernier::JointType::revolute ? 180 / std::numbers::pi : 1e3;
      out += vernier::message(joints[j] * factor, ',');
    }
    return out;
  }
};

}  // namespace support
