// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A calibration from measurements in memory, whatever the number of joints: what `calibrate` does with its files.

#include <memory>
#include <optional>
#include <string>

#include "calibrated_arm.hpp"
#include "found_reflectors.hpp"
#include "measured_data.hpp"
#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/calibration_report.hpp"
#include "vernier/io/report_input.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// What to calibrate, from what.
struct CalibrationTask {
  vernier::RobotDescription robot;     ///< the arm as designed
  MeasuredData train{};                ///< to learn from
  std::optional<MeasuredData> test{};  ///< held-out poses, as many stations; none: rows of `train`
  vernier::Index test_every = 5;       ///< K: every K-th row is held out, if `test` is none
  double test_fraction = 0;  ///< above 0: this share of the rows is held out at random, in place of every K-th
  vernier::CalibrateOptions calibrate{};       ///< of the calibration itself
  const vernier::SavedModel* prior = nullptr;  ///< an earlier calibration to start from; null: none
  std::string date{};                          ///< written into the model
  std::optional<double> accept{};              ///< largest mean held-out error that is accepted [m]
};

/// A calibration, assessed.
struct CalibrationOutcome {
  vernier::CalibrationReport report{};           ///< the assessment
  vernier::ReportInput page{};                   ///< what an HTML page shows of it
  std::shared_ptr<const CalibratedArm> model{};  ///< what is deployed, with the tool of the first reflector
  /// Of several reflectors: where each is, and its model.
  std::vector<FoundReflector> reflectors{};
  std::vector<std::shared_ptr<const CalibratedArm>> models{};
  std::string results{};  ///< all results as JSON text
};

/// Calibrates and assesses.
/// @throws std::invalid_argument for data of another number of joints, or an unusable option
/// @throws vernier::CalibrationFailure for data that do not support a calibration
CalibrationOutcome calibrate(const CalibrationTask& task, const vernier::FitOptions& fit);

/// Instances for N joints, which the other calls: compiled in a file each.
template <int N>
CalibrationOutcome calibrate_of(const CalibrationTask& task, const vernier::FitOptions& fit);

}  // namespace support
