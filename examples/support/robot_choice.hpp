#pragma once

/// @file
/// The arm a program works on: one of the catalogue, or one described in a file.

#include <string>
#include <vector>

#include "vernier/io/robot_file.hpp"

namespace support {

/// The names that `choose_robot` knows.
std::vector<std::string> catalogue_names();

/// An arm of the catalogue by its name, or the one that a JSON file describes.
/// @throws UsageError for a name that is neither
/// @throws vernier::DataError on a file that does not describe an arm
vernier::RobotDescription choose_robot(const std::string& name_or_file);

}  // namespace support
