// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The cameras and the board of a calibration, and where they are: what a model file keeps of them.

#include <string>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"

namespace vernier {

/// Cameras and board around an arm.
struct CameraSetup {
  bool on_flange = true;          ///< whether the flange carries the cameras; else it carries the board
  std::vector<Camera> cameras{};  ///< intrinsics
  /// Covariances of the nine intrinsics of each camera, in the order of `Camera::names`; zero for those that were held.
  /// None where they are unknown.
  std::vector<MatrixX> covariances{};
  std::vector<std::string> camera_names{};  ///< as many
  Board board{};                            ///< the printed board
  std::vector<std::string> board_names{};   ///< of the places of the board
  std::vector<Isometry3> in_base{};         ///< base_T_board of each place, or base_T_camera of each camera
  std::vector<Isometry3> in_flange{};       ///< flange_T_camera of each camera, or flange_T_board of each place
};

}  // namespace vernier
