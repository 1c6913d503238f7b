// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate --contacts` without measured poses: the geometry of an arm from what its tool point touches.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calibration_options.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/object_errors.hpp"
#include "vernier/io/report_input.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// An arm identified from contacts, assessed at objects.
struct ContactCalibration {
  vernier::ArmGeometry nominal;     ///< as designed
  vernier::ArmGeometry identified;  ///< its base frame is that of the design
  vernier::ContactReport report{};
  std::string held_out{};                         ///< which objects are held out, in words; empty: none
  vernier::Index touches = 0;                     ///< number of those that were learned from
  vernier::Index objects = 0;                     ///< likewise of objects
  std::vector<vernier::ObjectErrors> designed{};  ///< errors at held-out objects, or at all of them, links as designed
  std::vector<vernier::ObjectErrors> found{};     ///< at the same objects, as identified
  std::vector<vernier::Contact> assessed{};       ///< these objects
  std::vector<vernier::ReportFile> inputs{};      ///< that were read
  vernier::SourceFile model{};                    ///< that was saved; without a name where none was
  /// Errors of touches at those objects by another description of the arm, its tool registered by the others [m].
  std::function<vernier::ErrorStatistics(const vernier::RobotDescription&)> error_of{};
};

/// Errors of touches at objects [m].
vernier::VectorX touch_errors(const std::vector<vernier::ObjectErrors>& objects);

/// Reads contacts, holds objects out, identifies the geometry and saves it.
/// @param seed of random choices of objects
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for contacts that do not support a calibration
/// @throws UsageError for an earlier model of another arm, or a split that objects do not have
ContactCalibration identify_from_contacts(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                          std::uint64_t seed);

/// Does so, and prints what contacts determine and what they do not.
/// @return exit code
int calibrate_by_contacts(Program& program, const vernier::RobotDescription& robot, const CalibrationOptions& options);

}  // namespace support
