#pragma once

/// @file
/// The work behind `calibrate`: measured poses in, a calibrated arm and its held-out errors out.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vernier/core/fit_options.hpp"
#include "vernier/identification/fit_error_model.hpp"
#include "vernier/identification/reregister.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// A calibration that must not be used; the message says why, and what to do, in one line.
class CalibrationFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How rows are held out of a file.
enum class HoldOut {
  every,     ///< every k-th row
  random,    ///< a seeded share
  region_x,  ///< the share of rows farthest along x: the far end for odd seeds, the near end for even ones
  region_z,  ///< likewise along z
  time,      ///< the last share of the rows
};

/// How the priors of the joint errors are settled: by default from a few, or by a search over left-out poses.
enum class PriorTuning { none, pso, ga };

/// What to calibrate from, and how.
struct CalibrationSettings {
  std::vector<std::filesystem::path> data;         ///< measured poses, one file a station
  std::vector<std::filesystem::path> test{};       ///< measured poses held out, as many; empty: rows of `data` are
  std::vector<std::filesystem::path> distances{};  ///< measured distances, one file a fixed point; all are learnt from
  HoldOut hold_out = HoldOut::every;               ///< which rows of `data`
  vernier::Index test_every = 5;                   ///< row i is held out when i % test_every == 0
  double test_fraction = 0.2;                      ///< share of rows held out otherwise
  vernier::Index train_rows = 0;                   ///< learn from the first so many of a seeded shuffle; 0: from all
  vernier::Loss loss = vernier::Loss::huber;       ///< how residuals are weighed
  std::vector<std::string> fixed{};                ///< parameters that stay nominal
  bool positions_only = false;                     ///< measured orientations are ignored
  bool own_tools = false;                          ///< every station has its own tool
  int harmonics = 60;                              ///< of the joint-wise terms
  int joint_nodes = 0;                             ///< above 0: so many hidden nodes a joint in place of harmonics
  PriorTuning priors = PriorTuning::none;          ///< of the joint errors
  double distance_sigma = 0.03e-3;                 ///< of a measured distance [m]
  std::uint64_t seed = 1;                          ///< of splits and of the swarm
  int threads = 1;                                 ///< of the swarm
  std::filesystem::path save{};                    ///< where the calibrated arm goes; empty: nowhere
  std::string date{};                              ///< written into it
  vernier::ObserverRef observer{};                 ///< sees the swarms
};

/// Errors of the held-out poses after a stage.
struct StageErrors {
  std::string key;            ///< name in JSON
  std::string title;          ///< name in the table
  vernier::VectorX position;  ///< [m]
  vernier::VectorX rotation;  ///< [rad]; empty where orientations do not count
};

/// One joint, for figures.
struct JointPicture {
  std::vector<double> angle{}, before{}, after{};  ///< held-out poses: joint [rad], errors of two stages [m]
  std::vector<double> at{}, value{}, std{};        ///< what its transmission adds, over the measured range [rad]
  std::vector<std::pair<double, double>> measured_ranges{};  ///< [rad]
};

/// All that a calibration has to tell.
struct CalibrationReport {
  vernier::Index train_rows = 0, test_rows = 0, distances = 0;
  std::string split;                                     ///< how the test rows were chosen, in words
  std::vector<StageErrors> stages{};                     ///< in the order in which they were taken
  std::vector<vernier::ParameterEstimate> parameters{};  ///< base, chain, tool
  std::string summary;                                   ///< of the identification, in plain words
  std::vector<std::string> remarks{};                    ///< what else the user should know, a line each
  std::vector<std::string> verdict{};                    ///< what to do with it, a line each
  vernier::Index rank = 0, free = 0;
  double condition = 0;
  std::vector<std::string> weak{}, correlated{};
  vernier::Observability observability{};
  std::vector<vernier::BlockChoice> blocks{};  ///< what leave-one-pose-out said of the joint errors
  std::vector<JointPicture> joints{};
  vernier::Index gated = 0;      ///< test rows outside the measured joint ranges
  double worst_harm = 0;         ///< by how much the joint-wise model is worse than geometry, inside those ranges [m]
  double within_ellipsoids = 0;  ///< share of test rows within their predicted 95 % ellipsoid
  double fit_seconds = 0;        ///< from poses to error model, the search for priors included
};

/// Frames, geometry, gravity compliance, joint-wise terms, and a PSO-ELM on what is left; judged on held-out poses.
/// @throws CalibrationFailure when the data do not support a calibration; nothing is saved then
/// @throws vernier::DataError on a malformed file
/// @throws std::invalid_argument on a parameter in `fixed` that does not exist
CalibrationReport calibrate(const vernier::RobotDescription& robot, const CalibrationSettings& settings);

/// What may move when a fitted arm is registered again.
struct ReregistrationSettings {
  std::filesystem::path model;           ///< as `calibrate` saved it
  std::filesystem::path data;            ///< a handful of measured poses
  std::filesystem::path test{};          ///< measured poses to judge by; empty: the same
  vernier::ReregisterOptions options{};  ///< what may move
  bool positions_only = false;           ///< measured orientations are ignored
  std::filesystem::path save{};          ///< where the arm goes; empty: nowhere
  std::string date{};                    ///< written into it
};

/// What became of it.
struct ReregistrationReport {
  std::string robot;
  vernier::Index train_rows = 0, test_rows = 0;
  bool held_out = false;                               ///< whether it was judged by other poses than it was fitted to
  std::vector<StageErrors> stages{};                   ///< as_fitted, reregistered
  std::array<double, 6> base_change{}, tool_change{};  ///< translations [m] and rotation vectors [rad]
  std::vector<double> offsets{};                       ///< [rad, m]
};

/// Finds frames (and joint zeros) of a fitted arm again, keeps the rest.
/// @throws CalibrationFailure where the poses do not determine what may move, or do not fit the arm
/// @throws vernier::DataError on a malformed file
ReregistrationReport reregister(const ReregistrationSettings& settings);

}  // namespace support
