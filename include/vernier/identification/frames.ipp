#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

VERNIER_IMPL Vector3 trilaterate(const PointRows& points, const VectorX& distances) {
  const Index n = points.rows();
  require(n == distances.size() && n >= 1, "trilaterate: ", n, " points, ", distances.size(), " distances");
  // |p - a|^2 = l^2 is linear in a and |a|^2; about the mean of the points the two separate
  const Vector3 mean = centroid(points);
  MatrixX scatter = MatrixX::Zero(3, 3);
  Vector3 right = Vector3::Zero();
  for (Index i = 0; i < n; ++i) {
    const Vector3 centred = point(points, i) - mean;
    right += (distances(i) * distances(i) - centred.squaredNorm()) * centred;
    for (Index c = 0; c < 3; ++c)
      for (Index r = 0; r < 3; ++r) scatter(r, c) += centred(r) * centred(c);
  }
  const detail::RightSingular axes = detail::right_singular(scatter);
  Vector3 out = mean;
  for (Index k = 0; k < 3 && axes.values(k) > 1e-12 * axes.values(0); ++k) {
    const Vector3 axis = axes.vectors.col(k);
    out -= 0.5 * axis.dot(right) / axes.values(k) * axis;
  }
  return out;
}

namespace detail {

VERNIER_IMPL ArmGeometry starting_frames(const ArmGeometry& nominal, const Station& data, bool fit_base,
                                         bool fit_tool) {
  const Index n = data.size();
  require(n >= 1, "starting_frames: no samples");
  Isometry3 base = nominal.base().isometry(), tool = nominal.tool().isometry();
  if (data.lengths != nullptr) {
    if (!fit_base) return nominal;
    const Isometry3 turned = rigid_motion(rotation(base), Vector3::Zero());
    const ArmGeometry rotated = nominal.with_frames(FrameParameters(turned), nominal.tool());
    const Vector3 shift = -trilaterate(rotated.positions(data.joints()), *data.lengths);
    base = rigid_motion(rotation(base), shift);
    return nominal.with_frames(FrameParameters(base), nominal.tool());
  }
  const std::vector<Isometry3> flanges = nominal.with_frames({}, {}).poses(data.joints());
  const auto flange = [&](Index i) -> const Isometry3& { return flanges[static_cast<std::size_t>(i)]; };
  for (int round = 0; round < 50; ++round) {
    const Isometry3 before = base;
    if (fit_base) {
      PointRows points(n, 3);
      for (Index i = 0; i < n; ++i) set_point(points, i, transformed(flange(i), translation(tool)));
      base = register_points(points, *data.positions);
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
      sum += rotation(back) * data.orientations[static_cast<std::size_t>(i)];
    }
    tool = rigid_motion(nearest_rotation(sum), translation(tool));
  }
  return nominal.with_frames(fit_base ? FrameParameters(base) : nominal.base(),
                             fit_tool ? FrameParameters(tool) : nominal.tool());
}

}  // namespace detail
}  // namespace vernier
