// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The measurements that `calibrate` reads: what it learns from, what it holds out, and faults in the files.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration_options.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/camera/camera_setup.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/io/report_input.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/measurements/measurements.hpp"

namespace support {

/// All measurements of an arm, as far as files have them.
template <int N>
struct MeasuredFiles {
  std::vector<std::string> names;           ///< of the sets of poses: the file, with the reflector where it has several
  std::vector<vernier::Dataset<N>> files;   ///< poses as the files have them, one set a station and reflector
  vernier::Measurements<N> train;           ///< to learn from: poses, distances and contacts
  vernier::Measurements<N> test;            ///< held-out poses, stations as in `train`
  vernier::RowFingerprints fitted_rows;     ///< of rows of poses to learn from, before readings of a pose are joined
  std::string held_out;                     ///< which poses those are, in words
  std::vector<vernier::ReportFile> inputs;  ///< all files that were read
  double camera_error = 0;                  ///< mean distance on the board at left-out images [m]; 0 without images
  std::optional<vernier::CameraSetup> camera{};  ///< that saw the poses, where images show them
  /// Covariance of a fit with errors that its poses share, as those of one camera do; none where they share none.
  std::function<vernier::MatrixX(const vernier::ErrorModelEstimate&)> covariance{};

  /// Whether sets of poses have tools of their own: they are of several reflectors, or an option says so.
  bool has_own_tools(bool each) const {
    const auto& sets = train.sets();
    const auto differs = [&](const vernier::MeasuredSet& set) { return set.reflector != sets.front().reflector; };
    const auto end = sets.begin() + static_cast<std::ptrdiff_t>(train.poses().size());
    return train.poses().size() > 1 && (each || std::any_of(sets.begin(), end, differs));
  }
};

// Defined and compiled in calibration_data.cpp, for all numbers of joints.

/// A file of measured poses.
/// @throws vernier::DataError on a malformed file
template <int N>
vernier::Dataset<N> read_poses(const std::string& file, const CalibrationOptions& options,
                               std::span<const vernier::JointType> types);

/// Reads all files of measurements and holds poses out.
/// @param seed of random choices; for regions, whether the largest or the smallest values are held out
/// @throws vernier::DataError on a malformed file
/// @throws vernier::CalibrationFailure for fewer rows than are asked for
template <int N>
MeasuredFiles<N> read_measurements(const CalibrationOptions& options, std::span<const vernier::JointType> types,
                                   std::uint64_t seed);

/// Holds out some of poses that are no rows of a file of poses: images show them.
/// @param poses   one set a place, whose rows have an origin
/// @param options how, see `read_measurements`
template <int N>
MeasuredFiles<N> hold_out_poses(const vernier::Measurements<N>& poses, const CalibrationOptions& options,
                                std::span<const vernier::JointType> types, std::uint64_t seed);

/// A map as the key `controller` of a robot file.
std::string controller_key(const vernier::ControllerMap& map, std::span<const vernier::JointType> types);

/// What to say of a first file whose joints are one less than those of the chain: the controller with a passive joint
/// that makes it plausible; empty where there is none, or the file lacks something else.
template <int N>
std::string passive_joint_advice(const vernier::DescribedRobot<N>& robot, const CalibrationOptions& options);

/// Looks for faults in the files of poses and prints them, before a calibration may refuse them.
/// @return one audit a set of poses; without findings for sets too short to be audited
template <int N>
std::vector<vernier::DataAudit> audit_files(const vernier::DescribedRobot<N>& robot, const MeasuredFiles<N>& measured);

}  // namespace support
