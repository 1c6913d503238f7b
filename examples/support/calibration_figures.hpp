#pragma once

/// @file
/// Tables and figures of a calibration.

#include <filesystem>
#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"

namespace support {

/// Prints the errors of each stage as a table [mm, mrad].
void print_stages(const std::vector<vernier::StageErrors>& stages);

/// Draws held-out errors by stage, as distributions and pose by pose, then joint by joint: errors along the joint, what
/// its transmission adds, and the measured ranges.
void draw_calibration(const std::filesystem::path& folder, const std::string& robot,
                      const vernier::CalibrationReport& report);

}  // namespace support
