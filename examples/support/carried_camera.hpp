// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The options that say which camera and board there are, and which of them the flange carries.

#include <string>
#include <vector>

#include "cli.hpp"
#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/core/types.hpp"

namespace support {

/// Camera and board of a command line.
struct CarriedCamera {
  std::string mount{}, board{}, intrinsics{};  ///< empty: no camera
  std::vector<double> carried{};               ///< of camera or board in the flange's frame: mm, rotation vector in deg

  /// Whether there is a camera.
  bool given() const { return !mount.empty(); }
  /// Whether the flange carries it; else it carries the board.
  bool on_flange() const { return mount == "flange"; }

  /// Adds its options to a command line: --camera-mount, which needs the others, and they it.
  /// @param help of --camera-mount
  /// @return     --camera-mount
  Option add_to(Program& program, const std::string& help);
  /// The board of the file.
  /// @throws vernier::DataError on a malformed file; so does `camera`
  vernier::Board printed() const;
  /// The camera of the file.
  /// @throws UsageError for a camera without the size of its images
  vernier::Camera camera() const;
  /// Camera or board in the frame of the flange.
  vernier::Isometry3 in_flange() const;
};

/// Where boards, or cameras, stand in the base frame of an arm, with their names.
struct NamedPlaces {
  std::vector<std::string> names{};           ///< as the column `board` of a plan has them
  std::vector<vernier::Isometry3> in_base{};  ///< base_T_board, or base_T_camera
};

/// The key `places` of a JSON file, as `plan_poses --json` writes it.
/// @throws vernier::DataError on a malformed file
NamedPlaces read_places(const std::string& file);

}  // namespace support
