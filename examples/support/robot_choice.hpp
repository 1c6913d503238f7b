// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The arm a program works on: one of the catalogue, or one described in a file.

#include <string>
#include <vector>

#include "cli.hpp"
#include "vernier/io/robot_file.hpp"

namespace vernier {
struct UrdfChain;
}  // namespace vernier

namespace support {

/// The names that `choose_robot` knows.
std::vector<std::string> catalogue_names();

/// The options that name an arm.
struct RobotOptions {
  std::string robot;           ///< name in the catalogue, or a file
  std::string base_link;       ///< of a URDF file: where the chain begins; empty: the root
  std::string tip_link;        ///< likewise: where it ends; empty: the only link without a child
  std::string ur_calibration;  ///< factory calibration of an arm of Universal Robots; empty: none
  std::vector<std::string>
      controller_joints{};     ///< formulas of the chain's joints, see `ControllerMap`; none: the arm's
  std::vector<double> down{};  ///< direction of gravity where the first row stands; none: the arm's

  /// Adds them to a command line.
  /// @return `--robot`
  Option add_to(Program& program);
  /// Whether the arm is in a URDF file.
  bool is_urdf() const;
};

/// An arm of the catalogue by its name, or the one that a file describes: JSON, URDF (.urdf), or the kinematics file of
/// Universal Robots' driver (.yaml). What was ignored in it is printed.
/// @throws UsageError for a name that is neither, options that do not belong together, or a kind of file that this
/// build
///         cannot read
/// @throws vernier::DataError on a file that does not describe an arm
/// The controller's joints and the direction of gravity are those of the options, where these state them.
/// @param chain where given, becomes the chain of a URDF file
vernier::RobotDescription choose_robot(const RobotOptions& options, vernier::UrdfChain* chain = nullptr);
/// The same of a name alone.
vernier::RobotDescription choose_robot(const std::string& name_or_file);

}  // namespace support
