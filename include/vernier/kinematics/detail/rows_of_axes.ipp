// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/kinematics/detail/rows_of_axes.hpp"

#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"

namespace vernier::detail {

/// The first frame: z along the axis, its origin the axis' point nearest to the base, x next to the base's.
VERNIER_LOCAL Isometry3 frame_of_axis(const JointAxis& axis) {
  const Vector3 z = axis.direction;
  Vector3 x = std::abs(z.x()) < 0.9 ? Vector3(1, 0, 0) : Vector3(0, 1, 0);
  x -= x.dot(z) * z;
  x /= x.norm();
  const Vector3 y = z.cross(x), origin = axis.point - axis.point.dot(z) * z;
  Matrix3 turn;
  for (Index r = 0; r < 3; ++r) {
    turn(r, 0) = x(r);
    turn(r, 1) = y(r);
    turn(r, 2) = z(r);
  }
  return rigid_motion(turn, origin);
}

/// A row from a frame to the next axis, whose direction and point are in that frame.
/// @param theta the angle to be next to
VERNIER_LOCAL DhRow row_to_axis(const Vector3& direction, const Vector3& point, bool wanted, double theta) {
  const double nearly_parallel = std::cos(0.2);
  const Vector3 &u = direction, &w = point, up(0, 0, 1);
  const bool parallel = std::abs(u.z()) > nearly_parallel;
  const Vector3 foot = w - w.z() / u.z() * u;  // of the next axis in the plane z = 0, where they are parallel
  DhRow best;
  double farther = 0;
  for (const bool turned : {false, true}) {
    DhRow row;
    // on one and the same axis theta is free: it stays where it is wanted
    const bool free = parallel && std::hypot(foot.x(), foot.y()) < 1e-14;
    row.theta = free ? (wanted ? theta : 0) : parallel ? std::atan2(foot.y(), foot.x()) : std::atan2(u.x(), -u.y());
    if (turned && !free) row.theta += std::numbers::pi;
    const Matrix3 back = rotation_about(up, -row.theta);
    const Vector3 v = rotated(back, u);
    if (parallel) {
      row.a = rotated(back, foot).x();
      row.beta = std::asin(v.x());
      row.alpha = std::atan2(-v.y(), v.z());
    } else {
      const Vector3 p = rotated(back, w);
      const double t = -p.y() / v.y();
      row.alpha = std::atan2(-v.y(), v.z());
      row.a = p.x() + t * v.x();
      row.d = p.z() + t * v.z();
    }
    const double turns = std::round((row.theta - theta) / (2 * std::numbers::pi));
    row.theta -= turns * 2 * std::numbers::pi;
    const double distance = std::abs(row.theta - theta);
    constexpr double as_near = 1e-6;
    const bool better = wanted || std::abs(distance - farther) > as_near ? distance < farther : row.a > 0;
    if (!turned || better) {
      best = row;
      farther = distance;
    }
  }
  return best;
}

VERNIER_IMPL AxisRows rows_of_axes(std::span<const JointAxis> axes, std::span<const double> thetas) {
  demand(!axes.empty(), "rows_of_axes: no joints");
  demand(thetas.empty() || thetas.size() == axes.size(), "rows_of_axes: ", thetas.size(), " angles for ", axes.size(),
         " joints");
  AxisRows out{frame_of_axis(axes.front()), {}, {}};
  Isometry3 at = out.base;
  for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
    const JointAxis& next = axes[i + 1];
    const Vector3 direction = rotated_back(rotation(at), next.direction);
    const Vector3 point = rotated_back(rotation(at), next.point - translation(at));
    DhRow row = row_to_axis(direction, point, !thetas.empty(), thetas.empty() ? 0 : thetas[i]);
    row.joint = axes[i].type;
    at = composed(at, rigid_motion(rotation_about({0, 0, 1}, row.theta), {0, 0, 0}));
    out.frames.push_back(at);
    out.rows.push_back(row);
    const Matrix3 turn = times3(rotation_about({1, 0, 0}, row.alpha), rotation_about({0, 1, 0}, row.beta));
    at = composed(at, rigid_motion(turn, {row.a, 0, row.d}));
  }
  DhRow last;
  last.joint = axes.back().type;
  out.rows.push_back(last);
  out.frames.push_back(at);
  return out;
}

}  // namespace vernier::detail
