// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `calibrate` from measured poses, whatever the number of joints.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calibration_data.hpp"
#include "calibration_options.hpp"
#include "found_reflectors.hpp"
#include "vernier/calibration/calibration_report.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/core/fit_options.hpp"
#include "vernier/error_model/prior_objective.hpp"
#include "vernier/io/report_input.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace support {

/// Generations of a search of priors.
inline constexpr vernier::Index prior_generations = 15;

/// Sizes of joint errors by a swarm, or by a genetic algorithm.
/// @param objective of left-out poses
/// @param box       of its arguments
/// @param genetic   by a genetic algorithm
/// @param fit       seed, executor and observer
vernier::VectorX search_priors(const vernier::PriorObjective& objective, const vernier::Box& box, bool genetic,
                               const vernier::FitOptions& fit);

/// A calibration from measured poses, assessed.
struct PoseCalibration {
  vernier::ArmGeometry nominal;               ///< the arm as designed
  vernier::ArmGeometry identified;            ///< by geometry alone: in the error model, joint errors have their share
  vernier::CalibrationReport report{};        ///< the assessment
  std::string held_out{};                     ///< which poses are held out, in words
  std::vector<vernier::DataAudit> audits{};   ///< of the files of poses
  vernier::SourceFile model{};                ///< that was saved; without a name where none was
  std::vector<std::string> sets{};            ///< of poses: the file, with the reflector where it has several
  std::vector<FoundReflector> reflectors{};   ///< of files with several, or with `--own-tools`; else none
  std::vector<std::string> further_models{};  ///< of the other tools, in the order of `sets`
  vernier::ReportInput page{};                ///< what an HTML page shows; empty unless it is asked for
  /// Held-out position errors at the first station by another description of the arm, its base and tool registered by
  /// the poses to learn from [m].
  std::function<vernier::ErrorStatistics(const vernier::RobotDescription&)> error_of{};
};

/// Reads the measurements, calibrates, assesses the calibration and saves its model.
/// @param fit seed, executor and observer of everything
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for data that do not support a calibration
/// @throws UsageError for an earlier model of another arm
PoseCalibration calibrate_from_poses(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                     const vernier::FitOptions& fit);

/// Does so with other measurements, for an arm of N joints. Compiled in pose_calibration.cpp, for all numbers of
/// joints.
/// @param options see `options_for`
/// @param measure reads them, after an earlier model was read and fits
template <int N>
PoseCalibration calibrate_measured(const vernier::RobotDescription& robot, const CalibrationOptions& options,
                                   const vernier::FitOptions& fit,
                                   const std::function<std::shared_ptr<const MeasuredFiles<N>>()>& measure);

/// Options for an arm: with its gears, gravity and controller, with those frames unknown that it does not state as
/// known, and without what its passive joints hide, which it prints.
/// @param stations number of stations that measure, each with a frame of its own
/// @throws UsageError for a known base of several stations
CalibrationOptions options_for(CalibrationOptions options, const vernier::RobotDescription& arm, std::size_t stations);

}  // namespace support
