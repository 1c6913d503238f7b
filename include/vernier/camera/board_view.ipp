// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "vernier/camera/board_view.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier {

VERNIER_IMPL bool BoardView::sees(const Isometry3& camera_T_board) const {
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

VERNIER_IMPL Isometry3 BoardView::frontal() const {
  const Vector3 middle = board.middle();
  return rigid_motion(Matrix3::Identity(), Vector3(-middle.x(), -middle.y(), (nearest + farthest) / 2));
}

VERNIER_IMPL BoardPlaces propose_places(const BoardView& view, bool on_flange, const Isometry3& carried,
                                        std::span<const Isometry3> flanges, const MatrixX& joints, int count,
                                        double table) {
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
    std::size_t best = tried.size();
    std::pair<std::size_t, std::size_t> most{0, 0};  // bins, then configurations
    std::set<Bin> best_bins;
    for (std::size_t k = 0; k < tried.size(); ++k) {
      std::set<Bin> now = covered;
      for (const std::size_t i : seeing[k]) bins_of(i, now);
      const std::pair<std::size_t, std::size_t> gain{now.size(), seeing[k].size()};
      if (seeing[k].empty() || gain <= most) continue;
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
