// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The factory calibration of Universal Robots' arms, from the controller's file.

#include <string>

#include "vernier/io/robot_file.hpp"

namespace vernier {

/// An arm of Universal Robots with the factory calibration of its controller, the file `calibration.conf`:
///
///     [mounting]
///     delta_theta = [ 1.5961e-07, -0.9172, 7.1294, 0.0710, -1.6426e-06, 9.1729e-08]
///     delta_a = [ ... ]
///     delta_d = [ ... ]
///     delta_alpha = [ ... ]
///
/// Each has six values [rad, m], added to the nominal rows; other keys and sections are ignored. As there is no beta,
/// the controller places the nearly parallel axes 2 to 4 by d of up to hundreds of metres. The rows returned have d = 0
/// and beta there, are close to the nominal ones, and have the same poses, to the rounding of such lengths (1e-13 m).
/// The frames and everything else of the nominal arm stay as they are.
/// @param path    the file, of at most 1 MiB
/// @param nominal six revolute joints in the standard convention without beta, e.g. of `robots::ur10()`
/// @throws DataError naming file, line and key, also where the result is far from the nominal arm
/// @throws std::invalid_argument for another kind of nominal arm
VERNIER_API RobotDescription read_ur_calibration(const std::string& path, const RobotDescription& nominal);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/ur_calibration.ipp"
#endif
