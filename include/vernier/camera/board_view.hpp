// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which poses of a board a camera sees well, and where boards should stand so that an arm moves widely before them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "vernier/camera/board.hpp"
#include "vernier/camera/camera.hpp"
#include "vernier/core/rigid_motions.hpp"

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
  bool sees(const Isometry3& camera_T_board) const {
    const double distance = transformed(camera_T_board, board.middle()).norm();
    if (!(distance >= nearest && distance <= farthest)) return false;
    if (!(camera_T_board(2, 2) >= std::cos(largest_tilt))) return false;  // z points into the board
    const auto width = static_cast<double>(camera.width - 1), height = static_cast<double>(camera.height - 1);
    for (const Index k : {Index{0}, board.columns - 2, board.corners() - board.columns + 1, board.corners() - 1}) {
      const Vector3 corner = transformed(camera_T_board, board.corner(k));
      if (!(corner.z() > 0.01)) return false;
      const Vector2 pixel = project(camera, corner).pixel;
      if (!(pixel(0) >= margin * width && pixel(0) <= (1 - margin) * width)) return false;
      if (!(pixel(1) >= margin * height && pixel(1) <= (1 - margin) * height)) return false;
    }
    return true;
  }

  /// The board before the camera, unturned, at the middle of the distances.
  Isometry3 frontal() const {
    const Vector3 middle = board.middle();
    return rigid_motion(Matrix3::Identity(), Vector3(-middle.x(), -middle.y(), (nearest + farthest) / 2));
  }
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
inline BoardPlaces propose_places(const BoardView& view, bool on_flange, const Isometry3& carried,
                                  std::span<const Isometry3> flanges, const MatrixX& joints, int count, double table) {
  std::vector<Isometry3> ends;
  for (const Isometry3& flange : flanges) ends.push_back(composed(flange, carried));
  const Isometry3 frontal = on_flange ? view.frontal() : inverse_of(view.frontal());
  const auto sees = [&](const Isometry3& end, const Isometry3& place) {
    return view.sees(on_flange ? composed(inverse_of(end), place) : composed(inverse_of(place), end));
  };
  constexpr std::size_t most_tried = 200;
  const std::size_t step = (std::max)(std::size_t{1}, ends.size() / most_tried);
  std::vector<Isometry3> tried;
  std::vector<std::vector<std::size_t>> seeing;  // configurations, of each
  for (std::size_t k = 0; k < ends.size(); k += step) {
    Isometry3 place = composed(ends[k], frontal);
    if (on_flange && std::isfinite(table)) {  // face up: z points into the board
      const Vector3 middle = transformed(place, view.board.middle());
      const double yaw = std::atan2(place(1, 0), place(0, 0)), c = std::cos(yaw), s = std::sin(yaw);
      Matrix3 turn;
      turn << c, s, 0, s, -c, 0, 0, 0, -1;
      place = rigid_motion(turn, Vector3(Vector3(middle.x(), middle.y(), table) - turn * view.board.middle()));
    }
    constexpr double column = 0.2;  // the arm itself stands about the axis of its base [m]
    const Vector3 at = on_flange ? transformed(place, view.board.middle()) : translation(place);
    if (std::hypot(at.x(), at.y()) < column) continue;
    std::vector<std::size_t> who;
    for (std::size_t i = 0; i < ends.size(); ++i)
      if (sees(ends[i], place)) who.push_back(i);
    tried.push_back(place);
    seeing.push_back(std::move(who));
  }
  constexpr double bin = 0.1745;  // 10 degrees, or 0.17 m
  using Bin = std::pair<Index, long>;
  const auto bins_of = [&](std::size_t i, std::set<Bin>& out) {
    for (Index j = 0; j < joints.cols(); ++j)
      out.emplace(j, std::lround(std::floor(joints(static_cast<Index>(i), j) / bin)));
  };
  BoardPlaces out;
  out.place.assign(ends.size(), -1);
  std::set<Bin> covered;
  for (int round = 0; round < count; ++round) {
    std::size_t best = tried.size(), most = 0;
    std::set<Bin> best_bins;
    for (std::size_t k = 0; k < tried.size(); ++k) {
      std::set<Bin> now = covered;
      for (const std::size_t i : seeing[k]) bins_of(i, now);
      const std::size_t gain = 1000000 * (now.size() - covered.size()) + seeing[k].size();
      if (gain <= most) continue;
      most = gain;
      best = k;
      best_bins = std::move(now);
    }
    if (best == tried.size()) break;
    covered = std::move(best_bins);
    for (const std::size_t i : seeing[best])
      if (out.place[i] < 0) out.place[i] = static_cast<int>(out.in_base.size());
    out.in_base.push_back(tried[best]);
    seeing[best].clear();
  }
  return out;
}

}  // namespace vernier
