// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The kinematics file of Universal Robots' ROS driver.

#include <array>
#include <string>
#include <vector>

#include "vernier/urdf/export_note.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier {

/// The kinematics file of the ROS driver and description of Universal Robots (`default_kinematics.yaml`, or what
/// `ur_calibration` wrote): origins of six joints that turn about their z axes,
///
///     kinematics:
///       shoulder: {x: 0, y: 0, z: 0.1273, roll: 0, pitch: 0, yaw: 0}
///       upper_arm: ...
///       hash: calib_12345
///
/// with URDF's roll, pitch, yaw (Rz(yaw) Ry(pitch) Rx(roll)). They begin at the controller's base frame (`base`, and
/// `base_link_inertia` of the description: `base_link` turned half round) and end at the flange, `tool0`.
struct UrKinematics {
  /// Of shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3: parent_T_joint.
  std::array<Isometry3, 6> origins{};
  /// Which controller's kinematics they are; the driver compares it, and warns. Up to 64 letters, digits and
  /// underscores; empty: not stated.
  std::string hash;
  /// From which they were read.
  std::vector<SourceFile> files{};

  /// From rows, their frames where the rows end along the axes, as `ur_calibration` has them. What the last row has
  /// behind its axis is left out: it belongs to the tool.
  /// @param geometry six revolute joints in the standard convention; its base is part of the first origin
  /// @param hash     of the controller
  /// @throws std::invalid_argument for another arm
  VERNIER_API static UrKinematics of(const ArmGeometry& geometry, const std::string& hash);

  /// From the joints of a URDF file, whose axes must be z: the file's joint frames stay where they are.
  /// @param chain,geometry see `joint_origins`
  /// @param hash           of the controller
  /// @throws std::invalid_argument for another arm
  VERNIER_API static UrKinematics of(const UrdfChain& chain, const ArmGeometry& geometry, const std::string& hash);

  /// As an arm, base_T_tool0, without limits.
  /// @param name of the arm
  VERNIER_API RobotDescription robot(const std::string& name) const;

  /// As a file, in digits that read back exactly.
  /// @param note written as a comment
  /// @throws std::invalid_argument for a hash of other characters
  VERNIER_API std::string text(const ExportNote& note) const;
};

/// Reads such a file, of at most 64 KiB; numbers up to 1000 [m, rad].
/// @throws DataError naming file, line and key
VERNIER_API UrKinematics read_ur_kinematics(const std::string& path);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/ur_kinematics.ipp"
#endif
