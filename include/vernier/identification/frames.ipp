#pragma once

#include <Eigen/SVD>

#include "vernier/core/check.hpp"
#include "vernier/identification/frames.hpp"

namespace vernier {

VERNIER_IMPL Vector3 trilaterate(const PointRows& points, const VectorX& distances) {
  const Index n = points.rows();
  require(n == distances.size() && n >= 1, "trilaterate: ", n, " points, ", distances.size(), " distances");
  // |p - a|^2 = l^2 is linear in a and |a|^2; about the mean of the points the two separate
  const Vector3 mean = points.colwise().mean().transpose();
  Matrix3 scatter = Matrix3::Zero();
  Vector3 right = Vector3::Zero();
  for (Index i = 0; i < n; ++i) {
    const Vector3 centred = points.row(i).transpose() - mean;
    scatter += centred * centred.transpose();
    right += centred * (distances(i) * distances(i) - centred.squaredNorm());
  }
  Eigen::JacobiSVD<Matrix3, Eigen::NoQRPreconditioner> svd(scatter, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(1e-12);
  return mean - 0.5 * svd.solve(right);
}

namespace detail {

VERNIER_IMPL ArmGeometry starting_frames(const ArmGeometry& nominal, const Station& data, bool fit_base,
                                         bool fit_tool) {
  const Index n = data.size();
  require(n >= 1, "starting_frames: no samples");
  Isometry3 base = nominal.base().isometry(), tool = nominal.tool().isometry();
  if (data.lengths != nullptr) {
    if (!fit_base) return nominal;
    const ArmGeometry rotated = nominal.with_frames(FrameParameters(Isometry3(base.linear())), nominal.tool());
    base.translation() = -trilaterate(rotated.positions(data.joints()), *data.lengths);
    return nominal.with_frames(FrameParameters(base), nominal.tool());
  }
  const std::vector<Isometry3> flanges = nominal.with_frames({}, {}).poses(data.joints());
  const auto flange = [&](Index i) -> const Isometry3& { return flanges[static_cast<std::size_t>(i)]; };
  for (int round = 0; round < 50; ++round) {
    const Isometry3 before = base;
    if (fit_base) {
      PointRows points(n, 3);
      for (Index i = 0; i < n; ++i) points.row(i) = (flange(i) * tool.translation()).transpose();
      base = register_points(points, *data.positions);
    }
    if (!fit_tool) break;
    // base and flange are isometries, so the least-squares tool point is a mean
    Vector3 sum = Vector3::Zero();
    for (Index i = 0; i < n; ++i)
      sum += flange(i).linear().transpose() *
             (base.linear().transpose() * (data.position(i) - base * flange(i).translation()));
    tool.translation() = sum / static_cast<double>(n);
    if (!fit_base || (base.matrix() - before.matrix()).norm() <= 1e-12 * base.matrix().norm()) break;
  }
  if (fit_tool && data.oriented()) {
    Matrix3 sum = Matrix3::Zero();
    for (Index i = 0; i < n; ++i)
      sum += (base.linear() * flange(i).linear()).transpose() * data.orientations[static_cast<std::size_t>(i)];
    tool.linear() = nearest_rotation(sum);
  }
  return nominal.with_frames(fit_base ? FrameParameters(base) : nominal.base(),
                             fit_tool ? FrameParameters(tool) : nominal.tool());
}

}  // namespace detail
}  // namespace vernier
