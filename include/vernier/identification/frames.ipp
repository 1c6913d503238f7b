// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/register_points.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL ArmGeometry starting_frames(const ArmGeometry& nominal, const MeasuredSet& data, bool fit_base,
                                         bool fit_tool) {
  const Index n = data.size();
  demand(n >= 1, "starting_frames: no samples");
  Isometry3 base = nominal.base().isometry(), tool = nominal.tool().isometry();
  if (data.positions() == nullptr) {
    if (!fit_base || data.seen_from.rows() > 0) return nominal;
    const Isometry3 turned = rigid_motion(rotation(base), Vector3::Zero());
    const ArmGeometry rotated = nominal.with_frames(FrameParameters(turned), nominal.tool());
    MeasuredSet set = data;
    base = composed(set.register_base(rotated.poses(data.joints)), turned);
    return nominal.with_frames(FrameParameters(base), nominal.tool());
  }
  const std::vector<Isometry3> flanges = nominal.with_frames({}, {}).poses(data.joints);
  const auto flange = [&](Index i) -> const Isometry3& { return flanges[static_cast<std::size_t>(i)]; };
  for (int round = 0; round < 50; ++round) {
    const Isometry3 before = base;
    if (fit_base) {
      PointRows points(n, 3);
      for (Index i = 0; i < n; ++i) set_point(points, i, transformed(flange(i), translation(tool)));
      base = register_points(points, *data.positions());
    }
    if (!fit_tool) break;
    // base and flange are isometries, so the least-squares tool point is a mean
    const Isometry3 out_of_base = inverse_of(base);
    Vector3 sum = Vector3::Zero();
    for (Index i = 0; i < n; ++i) sum += transformed(inverse_of(flange(i)), transformed(out_of_base, data.position(i)));
    tool = rigid_motion(rotation(tool), sum / static_cast<double>(n));
    const double size = std::hypot(2, translation(base).norm());
    if (!fit_base || pose_difference(base, before).norm() <= 1e-12 * size) break;
  }
  if (fit_tool && data.oriented()) {
    Matrix3 sum = Matrix3::Zero();
    for (Index i = 0; i < n; ++i) {
      const Isometry3 back = inverse_of(composed(base, flange(i)));
      sum += rotation(back) * data.orientations()[static_cast<std::size_t>(i)];
    }
    tool = rigid_motion(nearest_rotation(sum), translation(tool));
  }
  return nominal.with_frames(fit_base ? FrameParameters(base) : nominal.base(),
                             fit_tool ? FrameParameters(tool) : nominal.tool());
}

VERNIER_IMPL ArmGeometry placed(const ArmGeometry& arm, MeasuredSet& set) {
  if (set.seen_from.rows() > 0) return arm;  // where the base stands has no effect
  const ArmGeometry unregistered = arm.with_frames({}, arm.tool());
  return arm.with_frames(FrameParameters(set.register_base(unregistered.poses(set.joints))), arm.tool());
}

}  // namespace detail
}  // namespace vernier
