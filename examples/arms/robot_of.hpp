// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An arm by its name in the catalogue, or of a file.

#include <string>
#include <vector>

#include "vernier/io/robot_file.hpp"

namespace support {

/// The arms of the catalogue.
std::vector<vernier::RobotDescription> robot_catalogue();

/// Whether a file is a URDF file, by its name.
bool is_urdf(const std::string& file);
/// Whether a file has the kinematics of Universal Robots' driver, by its name.
bool is_ur_kinematics(const std::string& file);

/// The arm of a file: JSON, URDF (.urdf), or the kinematics file of Universal Robots' driver (.yaml).
/// @param file      the file
/// @param base_link of a URDF file: where the chain begins; empty: the root
/// @param tip_link  of a URDF file: where it ends; empty: the only link without a child
/// @param remarks   what was ignored in the file is appended
/// @throws vernier::DataError on a file that does not describe an arm
/// @throws std::invalid_argument for a kind of file that this build cannot read
vernier::RobotDescription robot_of_file(const std::string& file, const std::string& base_link,
                                        const std::string& tip_link, std::vector<std::string>& remarks);

/// An arm of the catalogue by its name, or the one that a file describes.
/// @throws std::invalid_argument for a name that is neither, and as `robot_of_file`
vernier::RobotDescription robot_of(const std::string& name_or_file, const std::string& base_link,
                                   const std::string& tip_link, std::vector<std::string>& remarks);

}  // namespace support
