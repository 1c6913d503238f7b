// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What an exported file says about where its numbers come from.

#include <string>
#include <vector>

#include "vernier/evaluation/position_errors.hpp"

namespace vernier {

/// Where an exported geometry comes from, and what it is good for: a file of joint origins has no place for compliance,
/// gears or functions of single joints, so it is less accurate than the full model, and says by how much.
struct ExportNote {
  std::string robot;               ///< name of the arm
  std::string data;                ///< name of the file of measurements
  std::string date;                ///< of the export
  Index fitted_poses = 0;          ///< poses, or touches, it was fitted to
  std::string full_model;          ///< key of the stage of the calibration that the errors are compared with
  ErrorStatistics error_full;      ///< of held-out poses, by that stage [m]
  ErrorStatistics error_exported;  ///< of the same poses, by the exported geometry [m]
  std::string what = "poses";      ///< what these are: poses, touches
  bool held_out = true;            ///< whether they are none that it was fitted to

  /// As lines of a comment, with the library's version.
  VERNIER_API std::vector<std::string> lines() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/export_note.ipp"
#endif
