// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Figures of a calibration.

#include <filesystem>
#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"

namespace support {

/// Draws held-out errors by stage, as distributions and pose by pose, then joint by joint: errors along the joint, what
/// its transmission adds, and the measured ranges.
void draw_calibration(const std::filesystem::path& folder, const std::string& robot,
                      const vernier::CalibrationReport& report);

}  // namespace support
