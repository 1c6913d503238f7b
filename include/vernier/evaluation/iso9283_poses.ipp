// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/evaluation/iso9283_poses.hpp"

#include <algorithm>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/evaluation/detail/iso9283_visits.hpp"

namespace vernier {

VERNIER_IMPL std::array<Isometry3, 5> iso9283_poses(const Iso9283Cube& cube, const Matrix3& orientation, int plane) {
  demand(cube.edge > 0, "iso9283_poses: an edge of ", cube.edge, " m, must be positive");
  demand(plane >= 1 && plane <= 4, "iso9283_poses: plane ", plane, ", must be 1 to 4");
  const Isometry3 pose = rigid_motion(orientation, cube.centre);
  if (const char* fault = detail::fault_of_pose(pose, true)) demand(false, "iso9283_poses: ", fault);
  std::array<Vector3, 4> above{Vector3(1, 1, 1), Vector3(-1, 1, 1), Vector3(-1, -1, 1), Vector3(1, -1, 1)};
  const Vector3 first = above[static_cast<std::size_t>(plane - 1)], second = above[static_cast<std::size_t>(plane % 4)];
  std::array<Isometry3, 5> out;
  out.fill(pose);
  constexpr double share = 0.8;  // of half a diagonal: a tenth of the diagonal is left at each end
  const std::array<Vector3, 4> corners{first, second, -first, -second};
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3 arm = share * cube.edge / 2 * corners[k];
    out[k + 1] = rigid_motion(orientation, cube.centre + arm);
  }
  return out;
}

VERNIER_IMPL std::optional<Iso9283Cube> largest_iso9283_cube(const Vector3& lower, const Vector3& upper,
                                                             FunctionRef<bool(const Isometry3&)> reachable,
                                                             const Matrix3& orientation, int plane) {
  const Vector3 diagonal = upper - lower;
  demand(VERNIER_LATER(diagonal).minCoeff() > 0 && detail::all_finite(lower) && detail::all_finite(upper),
         "largest_iso9283_cube: the lower corner (", lower.x(), ", ", lower.y(), ", ", lower.z(),
         ") must be below the upper one (", upper.x(), ", ", upper.y(), ", ", upper.z(), ")");
  constexpr int edges = 50, half = 4;
  std::vector<Vector3> places;  // in units of the free play, the middle first
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j)
      for (int k = -half; k <= half; ++k) places.push_back(Vector3(i, j, k) / (2 * half));
  const auto key = [](const Vector3& a) { return std::array{a.squaredNorm(), a.x(), a.y(), a.z()}; };
  std::sort(places.begin(), places.end(), [&](const Vector3& a, const Vector3& b) { return key(a) < key(b); });
  for (int k = edges; k >= 1; --k) {
    const double edge = VERNIER_LATER(diagonal).minCoeff() * k / edges;
    for (const Vector3& place : places) {
      Iso9283Cube cube{.edge = edge};
      for (Index c = 0; c < 3; ++c) cube.centre(c) = (lower(c) + upper(c)) / 2 + place(c) * (diagonal(c) - edge);
      const std::array<Isometry3, 5> poses = iso9283_poses(cube, orientation, plane);
      if (std::all_of(poses.begin(), poses.end(), [&](const Isometry3& pose) { return reachable(pose); })) return cube;
    }
  }
  return {};
}

}  // namespace vernier
