// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --distances` without measured poses: an arm from distances of its tool point to fixed points.

#include "calibration_options.hpp"
#include "cli.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// Reads distances, holds some out, calibrates from the others, prints errors at those that were held out, and saves
/// the model: it stands in a frame whose origin is the first fixed point.
/// @return exit code
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for distances that do not support a calibration
/// @throws UsageError for an earlier model of another arm, or a split that distances do not have
int calibrate_by_distances(Program& program, const vernier::RobotDescription& robot, const CalibrationOptions& options);

}  // namespace support
