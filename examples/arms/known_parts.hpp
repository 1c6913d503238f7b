// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What of an arm is known, or hidden by its passive joints, and is therefore not identified.

#include <string>

#include "vernier/calibration/calibrate.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// Why a known base is refused beside several stations.
inline constexpr const char* known_base_of_stations =
    "the base frame of the arm is known, but there are several stations, each with a frame of its own";

/// Takes frames that the arm states as known from those that are identified, and holds what its passive joints hide.
/// @return the names of parameters that passive joints hide, joined by commas
std::string hold_known_parts(const vernier::RobotDescription& arm, vernier::CalibrateOptions& options);

}  // namespace support
