// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What single images of a flat board say: both of its possible poses, and the intrinsics of an unknown camera.

#include <array>
#include <span>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"

namespace vernier {

/// The homography that takes points of a plane to points seen, by the direct linear transform: `seen ~ H (x, y, 1)`.
/// @param plane,seen n >= 4 points, not on a line
/// @return           with H(2, 2) = 1; not finite where the points do not determine it
/// @cite Hartley and Zisserman 2004
VERNIER_API Matrix3 homography(std::span<const Vector2> plane, std::span<const Vector2> seen);

/// A pose of a board in the frame of a camera.
struct BoardPose {
  Isometry3 camera_T_board = Isometry3::Identity();  ///< where the board is
  double rms = 0;                                    ///< of the corners' distances in the image [px]
};

/// The two poses of a board that one image allows, refined by least squares; the one that fits better first. Where the
/// board is small, distant or seen frontally, both fit alike.
/// @param camera  with its distortion
/// @param board   flat
/// @param corners numbers of n >= 4 corners that are not on a line
/// @param pixels  where each is seen
/// @return        rms is infinite for a pose that does not exist
/// @cite Collins and Bartoli 2014
VERNIER_API std::array<BoardPose, 2> board_poses(const Camera& camera, const Board& board,
                                                 std::span<const Index> corners, std::span<const Vector2> pixels);

/// Focal lengths and principal point from homographies of a board of at least three orientations, without distortion.
/// @param homographies from the board [m] to pixels
/// @return             fx is 0 where they do not determine a camera
/// @cite Zhang 2000
VERNIER_API Camera camera_from_homographies(std::span<const Matrix3> homographies);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/camera/planar_pose.ipp"
#endif
