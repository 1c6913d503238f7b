#pragma once

#include "vernier/kinematics/detail/rows_of_axes.hpp"

#include <cmath>
#include <numbers>

#include "vernier/core/check.hpp"

namespace vernier::detail {

/// Motion about z.
VERNIER_API Matrix3 turned_about_z(double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
}

/// The first frame: z along the axis, its origin the axis' point nearest to the base, x next to the base's.
VERNIER_API Isometry3 frame_of_axis(const JointAxis& axis) {
  const Vector3 z = axis.direction;
  const Vector3 near = std::abs(z.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  Isometry3 frame;
  frame.linear().col(2) = z;
  frame.linear().col(0) = (near - near.dot(z) * z).normalized();
  frame.linear().col(1) = z.cross(frame.linear().col(0));
  frame.translation() = axis.point - axis.point.dot(z) * z;
  return frame;
}

/// A row from a frame to the next axis, whose direction and point are in that frame.
/// @param theta the angle to be next to
VERNIER_API DhRow row_to_axis(const Vector3& direction, const Vector3& point, bool wanted, double theta) {
  const double nearly_parallel = std::cos(0.2);
  const Vector3 &u = direction, &w = point;
  const bool parallel = std::abs(u.z()) > nearly_parallel;
  const Vector3 foot = w - w.z() / u.z() * u;  // of the next axis in the plane z = 0, where they are parallel
  DhRow best;
  double farther = 0;
  for (const bool turned : {false, true}) {
    DhRow row;
    // on one and the same axis theta is free: it stays where it is wanted
    const bool free = parallel && foot.head<2>().norm() < 1e-14;
    row.theta = free ? (wanted ? theta : 0) : parallel ? std::atan2(foot.y(), foot.x()) : std::atan2(u.x(), -u.y());
    if (turned && !free) row.theta += std::numbers::pi;
    const Matrix3 back = turned_about_z(-row.theta);
    const Vector3 v = back * u;
    if (parallel) {
      row.a = (back * foot).x();
      row.beta = std::asin(v.x());
      row.alpha = std::atan2(-v.y(), v.z());
    } else {
      const Vector3 p = back * w;
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
  require(!axes.empty(), "rows_of_axes: no joints");
  require(thetas.empty() || thetas.size() == axes.size(), "rows_of_axes: ", thetas.size(), " angles for ", axes.size(),
          " joints");
  AxisRows out{frame_of_axis(axes.front()), {}, {}};
  Isometry3 at = out.base;
  for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
    const JointAxis& next = axes[i + 1];
    const Vector3 direction = at.linear().transpose() * next.direction;
    const Vector3 point = at.linear().transpose() * (next.point - at.translation());
    DhRow row = row_to_axis(direction, point, !thetas.empty(), thetas.empty() ? 0 : thetas[i]);
    row.joint = axes[i].type;
    at.linear() = at.linear() * turned_about_z(row.theta);
    out.frames.push_back(at);
    out.rows.push_back(row);
    at = at * Eigen::Translation3d(row.a, 0, row.d) * Eigen::AngleAxisd(row.alpha, Vector3::UnitX()) *
         Eigen::AngleAxisd(row.beta, Vector3::UnitY());
  }
  DhRow last;
  last.joint = axes.back().type;
  out.rows.push_back(last);
  out.frames.push_back(at);
  return out;
}

}  // namespace vernier::detail
