// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which poses of a board a camera sees well, and where boards should stand so that an arm moves widely before them.

#include <span>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// How a camera must see a board.
struct BoardView {
  Camera camera;               ///< with the size of its images
  Board board;                 ///< the printed board
  double nearest = 0.3;        ///< least distance from the camera to the middle of the board [m]
  double farthest = 1;         ///< largest one [m]
  double largest_tilt = 0.87;  ///< between the view axis and the board's normal [rad]
  double margin = 0.02;        ///< that stays free at the edges, as a share of the image

  /// Whether the whole board is in the image, from its printed side, within distances and tilt.
  VERNIER_API bool sees(const Isometry3& camera_T_board) const;

  /// The board before the camera, unturned, at the middle of the distances.
  VERNIER_API Isometry3 frontal() const;
};

/// Where boards, or cameras, stand, and which configurations see which.
struct BoardPlaces {
  std::vector<Isometry3> in_base{};  ///< base_T_board of each place, or base_T_camera
  std::vector<int> place{};          ///< of each configuration; -1 where it sees none
};

/// Proposes places of a board that stands still, or of a camera, one after another: each lets the joints be seen in the
/// most new parts of their ranges, in bins of 10 degrees or 0.17 m. None is nearer than 0.2 m to the axis of the base.
/// @param view      what is seen well
/// @param on_flange whether the flange carries the camera; else it carries the board
/// @param carried   flange_T_camera, or flange_T_board
/// @param flanges   base_T_flange at n configurations
/// @param joints    of these, n x joints [rad, m]
/// @param count     number of places, at most
/// @param table     height of a horizontal table on which boards lie, face up, in the base frame [m]; not finite:
///                  boards stand anywhere
VERNIER_API BoardPlaces propose_places(const BoardView& view, bool on_flange, const Isometry3& carried,
                                       std::span<const Isometry3> flanges, const MatrixX& joints, int count,
                                       double table);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/board_view.ipp"
#endif
