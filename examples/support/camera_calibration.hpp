// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --corners`: an arm, or base and tool alone, from images of a printed board.

#include <filesystem>
#include <string>

#include "calibration_options.hpp"
#include "cli.hpp"
#include "json_file.hpp"
#include "vernier/calibration/camera_calibration.hpp"
#include "vernier/camera/camera_setup.hpp"
#include "vernier/data/csv_format.hpp"

namespace support {

/// Intrinsics of a file: JSON, or YAML of OpenCV or ROS.
/// @throws UsageError for YAML, if this build cannot read it
/// @throws vernier::DataError on a malformed file
vernier::Camera read_camera(const std::string& file);

/// What images need beside the joints.
struct CameraInputs {
  vernier::Board board;
  vernier::CornerViews views;
  vernier::CsvFormat format;
  vernier::CameraOptions options;
};

/// Reads board, corners and intrinsics.
/// @throws UsageError for another number of files of intrinsics than of cameras
/// @throws vernier::DataError on a malformed file
CameraInputs read_camera_inputs(const CalibrationOptions& options);

/// The share of the time of a calibration by cameras that has passed after some of its steps.
inline double share_of_images(vernier::Index steps) {
  return static_cast<double>(steps) / static_cast<double>(vernier::camera_steps);
}

/// What a saved model says of the images.
vernier::CameraSetup setup_of(const vernier::CameraReport& report);

/// The lines of its verdict under a title.
std::string camera_verdict(const vernier::CameraReport& report, const char* title);
/// Frames, intrinsics and links for --parameters, and errors by image for --verbose.
std::string camera_details(const vernier::CameraReport& report, const CalibrationOptions& options);

/// Results as JSON.
Json camera_json(const vernier::CameraReport& report);

/// Draws what is left of the corners over the image of each camera.
void draw_cameras(const std::filesystem::path& folder, const vernier::CameraReport& report);

/// Reads corners, board and joints, or poses of the flange, prints what they determine and saves the model.
/// @return exit code
/// @throws UsageError for a camera file that this build cannot read
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for images that do not determine it
int calibrate_by_camera(Program& program, const CalibrationOptions& options);

}  // namespace support
