#pragma once

/// @file
/// The work behind `calibrate`: measured poses in, a calibrated arm and its held-out errors out.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "vernier/core/fit_options.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// A calibration that must not be used; the message says why, and what to do, in one line.
class CalibrationFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What to calibrate from, and how.
struct CalibrationSettings {
  std::filesystem::path data;             ///< measured poses
  std::filesystem::path test{};           ///< measured poses held out; empty: rows of `data` are
  std::optional<double> test_fraction{};  ///< share of rows held out at random
  vernier::Index test_every = 5;          ///< row i is held out when i % test_every == 0, where nothing else is asked
  vernier::Loss loss = vernier::Loss::squared;  ///< of the identification
  std::vector<std::string> fixed{};             ///< parameters that stay nominal
  bool positions_only = false;                  ///< measured orientations are ignored
  std::uint64_t seed = 1;                       ///< of the random split and of the swarm
  int threads = 1;                              ///< of the swarm
  std::filesystem::path save{};                 ///< where the calibrated arm goes; empty: nowhere
  std::string date{};                           ///< written into it
  vernier::ObserverRef observer{};              ///< sees the swarm
};

/// Errors of the held-out poses after a stage.
struct StageErrors {
  std::string key;            ///< name in JSON
  std::string title;          ///< name in the table
  vernier::VectorX position;  ///< [m]
  vernier::VectorX rotation;  ///< [rad]; empty where orientations do not count
};

/// All that a calibration has to tell.
struct CalibrationReport {
  vernier::Index train_rows = 0, test_rows = 0;
  std::string split;                                     ///< how the test rows were chosen, in words
  std::vector<StageErrors> stages{};                     ///< frames, geometry, geometry_pso_elm
  std::vector<vernier::ParameterEstimate> parameters{};  ///< base, chain, tool
  std::string summary;                                   ///< of the identification, in plain words
  std::vector<std::string> remarks{};                    ///< what else the user should know, a line each
  vernier::Index rank = 0, free = 0;
  double condition = 0;
  std::vector<std::string> weak{};
};

/// Frames, then geometry, then a PSO-ELM on what is left; judged on held-out poses.
/// @throws CalibrationFailure when the data do not support a calibration; nothing is saved then
/// @throws vernier::DataError on a malformed file
/// @throws std::invalid_argument on a parameter in `fixed` that does not exist
CalibrationReport calibrate(const vernier::RobotDescription& robot, const CalibrationSettings& settings);

}  // namespace support
