#pragma once

/// @file
/// The measurements that `calibrate` reads: what it learns from, what it holds out, and faults in the files.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calibration_options.hpp"
#include "vernier/calibration/data_audit.hpp"
#include "vernier/data/dataset.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// All measurements of an arm.
template <int N>
struct Measurements {
  std::vector<vernier::Dataset<N>> files;        ///< poses as the files have them, one set a station
  std::vector<vernier::Dataset<N>> train;        ///< poses to learn from, one set a station
  std::vector<vernier::Dataset<N>> test;         ///< held-out poses, likewise
  std::string held_out;                          ///< which poses those are, in words
  std::vector<vernier::Distances<N>> distances;  ///< one set a fixed point
  std::vector<vernier::Contact> contacts;        ///< what the tool point touched
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
Measurements<N> read_measurements(const CalibrationOptions& options, std::span<const vernier::JointType> types,
                                  std::uint64_t seed);

/// Looks for faults in the files of poses and prints them, before a calibration may refuse them.
/// @param files poses of the files `options.data`
/// @return one audit a file; without findings for files too short to be audited
template <int N>
std::vector<vernier::DataAudit> audit_files(const CalibrationOptions& options, const vernier::DescribedRobot<N>& robot,
                                            const std::vector<vernier::Dataset<N>>& files);

}  // namespace support
