// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/simulation/views.hpp"

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier {

VERNIER_IMPL View seen_view(const Camera& camera, const Board& board, const Isometry3& camera_T_board, double noise,
                            Rng& rng) {
  demand(camera.width > 0 && camera.height > 0, "seen_view: the size of the camera's images is unknown");
  View out;
  out.width = camera.width;
  out.height = camera.height;
  const Vector3 to_board = transformed(camera_T_board, board.middle());
  if (!(camera_T_board.linear().col(2).dot(to_board) > 0)) return out;  // z points into the board
  for (Index k = 0; k < board.corners(); ++k) {
    const Vector3 corner = transformed(camera_T_board, board.corner(k));
    constexpr double nearest = 0.01;  // [m]
    if (!(corner.z() > nearest)) continue;
    const Vector2 pixel = project(camera, corner).pixel;
    if (!(pixel(0) >= 0 && pixel(0) <= static_cast<double>(camera.width - 1))) continue;
    if (!(pixel(1) >= 0 && pixel(1) <= static_cast<double>(camera.height - 1))) continue;
    // far outside, distortion folds back into the image; no lens does that
    const Vector2 at(corner.x() / corner.z(), corner.y() / corner.z());
    if (!((normalised(camera, pixel) - at).norm() < 1e-6)) continue;
    const auto [along_u, along_v] = rng.normal_pair();
    out.corners.push_back(k);
    out.pixels.emplace_back(pixel(0) + noise * along_u, pixel(1) + noise * along_v);
  }
  return out;
}

VERNIER_IMPL CornerViews simulate_views(const CameraSetup& setup, std::span<const Shot> shots, double noise,
                                        std::uint64_t seed) {
  const auto& per_camera = setup.on_flange ? setup.in_flange : setup.in_base;
  const auto& per_board = setup.on_flange ? setup.in_base : setup.in_flange;
  demand(per_camera.size() == setup.cameras.size() && setup.camera_names.size() == setup.cameras.size() &&
             per_board.size() == setup.board_names.size(),
         "simulate_views: ", setup.cameras.size(), " cameras with ", setup.camera_names.size(), " names in ",
         per_camera.size(), " frames, ", per_board.size(), " places of the board with ", setup.board_names.size(),
         " names");
  CornerViews out;
  out.cameras = setup.camera_names;
  out.boards = setup.board_names;
  Rng rng(seed);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const auto camera = static_cast<std::size_t>(shots[i].camera), board = static_cast<std::size_t>(shots[i].board);
    demand(camera < per_camera.size() && board < per_board.size(), "simulate_views: image ", i + 1, " is of camera ",
           shots[i].camera, " and place ", shots[i].board, ", of ", per_camera.size(), " and ", per_board.size());
    const Isometry3 moved = composed(shots[i].flange, setup.in_flange[setup.on_flange ? camera : board]);
    const Isometry3& standing = setup.in_base[setup.on_flange ? board : camera];
    View view = seen_view(
        setup.cameras[camera], setup.board,
        setup.on_flange ? composed(inverse_of(moved), standing) : composed(inverse_of(standing), moved), noise, rng);
    view.image = message("image", i + 1, ".png");
    view.camera = shots[i].camera;
    view.board = shots[i].board;
    if (!view.corners.empty()) out.views.push_back(std::move(view));
  }
  return out;
}

}  // namespace vernier
