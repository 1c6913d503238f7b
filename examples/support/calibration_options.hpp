// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The command line of `calibrate`.

#include <functional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "csv_options.hpp"
#include "robot_choice.hpp"
#include "sensor_options.hpp"
#include "vernier/calibration/calibrate.hpp"

namespace support {

/// What the command line of `calibrate` says.
struct CalibrationOptions {
  RobotOptions robot;                  ///< the arm as designed
  std::vector<std::string> data;       ///< files of measured poses, one a station
  std::vector<std::string> test;       ///< held-out poses, as many files; empty: rows of `data` are held out
  std::vector<std::string> distances;  ///< files of measured distances, one a fixed point
  std::string contacts;                ///< file of contacts; empty: none
  std::string corners;                 ///< file of a board's corners in images; empty: none
  std::string board;                   ///< file of that board
  std::string camera_mount;            ///< flange or fixed
  std::vector<std::string>
      intrinsics;  ///< files of cameras, in the order in which the corners name them; none: unknown
  std::vector<std::string> free_intrinsics;  ///< names of those that are estimated although they are given
  std::string save_poses;                    ///< file for poses that images show; empty: none
  bool joint_errors = false;                 ///< joint errors are found from the poses that images show
  std::string flange_poses;                  ///< file of poses of the flange in place of joints; empty: none
  CsvOptions csv;                            ///< how these files are written
  SensorOptions sensor;                      ///< accuracy of measured poses; `calibrate.sensors` has it, too
  std::string split;                         ///< how a fraction of the rows is held out; empty: every K-th row
  bool holds_out = false;                    ///< whether the command line says what is held out; of poses always some
  vernier::Index test_every = 5;             ///< that K
  double test_fraction = 0.2;                ///< that fraction
  vernier::Index train_rows = 0;             ///< rows to learn from; 0: all that are not held out
  bool no_approach = false;                  ///< rows are not in the order of measuring
  std::string priors = "default";            ///< how sizes of the joint errors are found: default, pso or ga
  std::string prior;                         ///< an earlier calibrated model to start from; empty: none
  std::string save;                          ///< file for the calibrated model; empty: none
  std::string date;                          ///< written into the model
  std::string report;                        ///< file for the HTML page; empty: none
  double accept_mm = 0;                      ///< largest mean held-out error that is accepted [mm]; 0: not stated
  bool verbose = false;                      ///< details are printed as well
  bool parameters = false;                   ///< identified frames and links are printed as well
  bool reregister = false;                   ///< a saved model is registered again, instead of a calibration
  std::string model;                         ///< that model
  std::string free;                          ///< what may move then
  vernier::CalibrateOptions calibrate{};     ///< of the calibration itself
  std::function<void(double)> reached = [](double) {};  ///< told the share of the work that is done, up to a search
};

/// Reads the command line of `calibrate` and refuses options that do not belong together.
/// @throws UsageError for those
/// @throws std::runtime_error where a file that will be written cannot be
CalibrationOptions read_calibration_options(Program& program);

}  // namespace support
