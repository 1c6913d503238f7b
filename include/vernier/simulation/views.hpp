// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Images of a virtual arm: where cameras see the corners of a printed board.

#include <cstdint>
#include <span>

#include "vernier/camera/camera_setup.hpp"
#include "vernier/camera/corner_views.hpp"
#include "vernier/core/rng.hpp"

namespace vernier {

/// The corners that a camera sees of a board, each with noise. Corners outside the image are missing, and all are if
/// the print faces away.
/// @param camera with the size of its images
/// @param camera_T_board pose of the board in the camera's frame [m]; z of the board points into the print
/// @param noise  standard deviation of a corner, per component [px]
/// @throws std::invalid_argument for a camera without the size of its images
VERNIER_API View seen_view(const Camera& camera, const Board& board, const Isometry3& camera_T_board, double noise,
                           Rng& rng);

/// Where an image is taken.
struct Shot {
  Isometry3 flange = Isometry3::Identity();  ///< base_T_flange
  Index camera = 0;                          ///< number of the camera
  Index board = 0;                           ///< number of the board's place
};

/// Images of an arm, named image1.png and so on. Those that show no corner have no view.
/// @param setup cameras and boards as they are, with their names
/// @param noise standard deviation of a corner, per component [px]
/// @param seed  same seed, same corners
/// @throws std::invalid_argument for a camera or place that the setup lacks, and a camera without the size of its
/// images
VERNIER_API CornerViews simulate_views(const CameraSetup& setup, std::span<const Shot> shots, double noise,
                                       std::uint64_t seed);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/simulation/views.ipp"
#endif
