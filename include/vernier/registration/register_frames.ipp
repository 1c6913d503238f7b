// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/registration/register_frames.hpp"

#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/detail/point_alignment.hpp"

namespace vernier::detail {

VERNIER_IMPL RegisteredFrames register_flanges(std::span<const Isometry3> flanges, const PointRows& positions,
                                               const PointRows& orientations) {
  const auto n = static_cast<Index>(flanges.size());
  demand(n >= 6, "register_frames: ", n, " poses, needs six or more");
  std::vector<PointPair> pairs;
  for (Index i = 0; i < n; ++i) pairs.push_back({i, i});
  const PointFrames found = fit_point_frames(flanges, positions, pairs);
  Matrix3 tool = Matrix3::Zero();
  for (Index i = 0; i < orientations.rows(); ++i)
    tool += (rotation(found.base) * rotation(flanges[static_cast<std::size_t>(i)])).transpose() *
            exp_so3(point(orientations, i));
  if (orientations.rows() == 0) tool.setIdentity();
  return {found.base, rigid_motion(nearest_rotation(tool), found.offset)};
}

}  // namespace vernier::detail
