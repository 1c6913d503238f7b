#pragma once

/// @file
/// The work behind `correct`: a calibrated model and targets in, corrected commands out.

#include <filesystem>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace support {

/// What became of the targets.
struct CorrectionReport {
  std::string robot;                     ///< name in the model
  std::vector<double> errors{};          ///< distance from each target that the model predicts for its command [m]
  std::vector<vernier::Index> missed{};  ///< targets that are not met, counted from 0
  vernier::Index extrapolated = 0;  ///< targets outside the measured joint ranges, where the learned part fades out
};

/// Corrects every target and writes the commands, whole or not at all: columns q1_rad .. (q1_m for a prismatic joint),
/// status, predicted_error_mm, gate.
/// @param poses the targets are poses x_mm, y_mm, z_mm, rx_rad, ry_rad, rz_rad in the frame of the measurements, their
/// joints only seeds that choose the branch; else the targets are where the nominal arm stands at the joints
/// @throws vernier::DataError on a malformed file
/// @throws std::runtime_error where the commands cannot be written
CorrectionReport correct_targets(const std::filesystem::path& model, const std::filesystem::path& targets, bool poses,
                                 const std::filesystem::path& out);

}  // namespace support
