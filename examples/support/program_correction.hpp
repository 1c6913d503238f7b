// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `correct --program`: the literal targets of a robot program corrected in place.

#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "payload_option.hpp"
#include "vernier/core/types.hpp"

namespace support {

/// What the command line says about the program that is to be corrected.
struct ProgramCorrection {
  std::string program{};                       ///< its file; empty: targets are in a table
  std::string controller{};                    ///< kinematics of the controller: nominal, or a file
  std::vector<std::string> tools{};            ///< frames x,y,z,rx,ry,rz [mm, deg], or NAME=frame
  std::vector<std::string> workobjects{};      ///< likewise
  std::string robot_base{};                    ///< the controller's base in the frame of the model's chain
  std::string flange{};                        ///< the controller's flange in the last frame of that chain
  std::string noflip{};                        ///< Fanuc: sign of joint 5 where the configuration is N
  std::string date{};                          ///< written into the program
  std::vector<std::string> assume_harmless{};  ///< statements that change nothing that targets mean
  bool allow_uncorrected = false;              ///< whether the rest may stay as it is
};

/// What `correct` says to all kinds of targets.
struct CorrectionInput {
  std::string model{};                  ///< file of the calibrated model
  std::string out{};                    ///< file to be written
  std::string json{};                   ///< results; empty: none
  std::optional<double> temperature{};  ///< of the arm [deg C]
  PayloadOption payload{};              ///< what it carries
  std::vector<double> start{};          ///< joint values before the first target [rad]
  bool approach = true;                 ///< whether commands are executed in the order of the text
};

/// A frame x,y,z,rx,ry,rz: position in mm and rotation vector in degrees.
/// @throws UsageError naming the option
vernier::Isometry3 frame_of(const std::string& text, const char* option);

/// Adds the options of a program's correction.
void add_program_options(Program& program, ProgramCorrection& to);

/// Corrects a program and writes it, unless it has something that cannot be corrected and that is not allowed.
/// @return exit code
/// @throws vn::DataError on a malformed file; UsageError for options that do not fit it
int correct_program(const ProgramCorrection& options, const CorrectionInput& input);

}  // namespace support
