// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Cameras as OpenCV and ROS write them in YAML files.

#include <string>

#include "vernier/camera/camera.hpp"

namespace vernier {

/// A camera from a YAML file of OpenCV or of ROS's camera_info: `camera_matrix`, `distortion_coefficients` (k1, k2, p1,
/// p2, k3; k3 may be missing), `image_width`, `image_height`, and the `distortion_model` plumb_bob where one is named.
/// Other models, a skew, and further coefficients that are not zero are refused.
/// @throws DataError naming file, line and key
VERNIER_API Camera read_camera_yaml(const std::string& path);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/camera_yaml.ipp"
#endif
