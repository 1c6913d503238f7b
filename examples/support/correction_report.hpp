// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What `correct` made of its targets: as CSV, in sentences, as JSON and as figures.

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "joint_units.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/dh.hpp"
#include "vernier/kinematics/singularities.hpp"

namespace support {

/// One command.
struct CommandRow {
  std::vector<double> command;  ///< joint values [rad, m]; NaN where there is none
  vernier::Index target;        ///< counted from 1
  std::string kind;             ///< target, inserted, or branch and its number
  std::string status;           ///< converged, or what keeps the target from being met
  double error, rotation;       ///< what the model predicts to be left [m, rad]
  double deviation;             ///< from the line of the linear move to it [m]
  double ends_only;             ///< that of the whole move, were its ends alone corrected [m]
  double gate;                  ///< share of the learned correction that was used
  vernier::SingularityDistances singularities;
  std::vector<vernier::Vector3> links{};  ///< origins of the joints and the tool [m]; of branches
  double radius = std::nan("");           ///< of 95 % [m]
  vernier::Vector3 point = vernier::Vector3::Constant(std::nan(""));  ///< where the model sees the tool [m]
  std::optional<vernier::Isometry3> commanded{};  ///< the pose to command, where targets are poses of the controller
};

/// All commands of one run.
struct CorrectionReport {
  std::string robot{};                       ///< name in the model
  std::vector<vernier::JointType> joints{};  ///< types of its joints
  std::vector<CommandRow> rows{};            ///< commands
  vernier::Index targets = 0;                ///< number of targets
  double expected_error = 0;                 ///< of the model, at poses it was not fitted to [m]; 0: unknown
  bool held_out = false;                     ///< whether that is the mean of held-out poses, not rms of left-out ones
  bool linear = false;                       ///< whether there are linear moves
  bool branches = false;                     ///< whether rows are all branches of each target
  double before = 0, after = 0;              ///< largest deviation from the lines [m]
  std::optional<double> temperature{};       ///< for which commands are corrected [deg C], where that matters
  bool clamped = false;                      ///< whether the temperature asked for is not that
  bool temperature_given = false;            ///< whether one was asked for
};

/// What became of the targets, in numbers.
struct CorrectionTotals {
  vernier::Index met = 0, inserted = 0, not_found = 0, proven_out = 0, jumps = 0, extrapolated = 0;
  double mean = 0, largest = 0;             ///< predicted errors [mm]
  std::vector<vernier::Index> missed{};     ///< targets that are not met
  std::vector<vernier::Index> displaced{};  ///< targets whose move leaves its branch or its line
};

/// The totals of a report.
CorrectionTotals totals(const CorrectionReport& report);

/// Columns q1_rad .. (q1_m for a prismatic joint), then what became of each command.
std::string correction_csv(const CorrectionReport& report, const JointUnits& units);

/// The report as JSON.
nlohmann::json correction_json(const CorrectionReport& report, const CorrectionTotals& totals);

/// Prints what became of the targets.
void print_correction(const CorrectionReport& report, const CorrectionTotals& totals);

/// The complaint about targets that are not met as asked; empty where all are.
/// @param file that has the rows
std::string correction_failure(const CorrectionReport& report, const CorrectionTotals& totals, const std::string& file);

/// Draws the deviation of the tool over the length of the path, before and after; the links of all branches of the
/// first target.
/// @return whether there was something to draw, and something to draw it with
bool draw_correction(const std::filesystem::path& path, const CorrectionReport& report);

}  // namespace support
