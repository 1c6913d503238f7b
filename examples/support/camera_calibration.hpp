// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --corners`: an arm, or base and tool alone, from images of a printed board.

#include <string>

#include "calibration_options.hpp"
#include "cli.hpp"
#include "vernier/camera/camera.hpp"

namespace support {

/// Intrinsics of a file: JSON, or YAML of OpenCV or ROS.
/// @throws UsageError for YAML, if this build cannot read it
/// @throws vernier::DataError on a malformed file
vernier::Camera read_camera(const std::string& file);

/// Reads corners, board and joints, or poses of the flange, prints what they determine and saves the model.
/// @return exit code
/// @throws UsageError for a camera file that this build cannot read
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for images that do not determine it
int calibrate_by_camera(Program& program, const CalibrationOptions& options);

}  // namespace support
