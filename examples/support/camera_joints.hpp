// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --corners --joint-errors`: joint errors of an arm from images, in one run with intrinsics and geometry.

#include "calibration_options.hpp"
#include "pose_calibration.hpp"
#include "vernier/calibration/camera_report.hpp"

namespace support {

/// A calibration from the poses that images show, and the camera that showed them.
struct CameraJoints {
  PoseCalibration poses;
  vernier::CameraReport camera;
  std::vector<double> moved{};  ///< how far each round moved the intrinsics, in standard deviations
  bool converged = false;
  double image_error = 0;  ///< of the held-out poses by their own images, root mean square [m]
};

/// Reads corners, board and joints; finds intrinsics, geometry and joint errors in turn until they rest, and assesses
/// the result at held-out images, whose corners have their share in the intrinsics alone.
/// @param fit seed, executor and observer of everything
/// @throws as `calibrate_by_camera` and `calibrate_from_poses` do
CameraJoints calibrate_joints_by_camera(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                        const vernier::FitOptions& fit);

}  // namespace support
