#pragma once

/// @file
/// Closed-form starting values for base and tool frames.

#include <Eigen/LU>
#include <Eigen/SVD>
#include <vector>

#include "vernier/data/dataset.hpp"
#include "vernier/data/distances.hpp"
#include "vernier/kinematics/framed.hpp"

namespace vernier {

/// The rotation nearest to a matrix (in the Frobenius norm), e.g. the mean of a sum of rotations.
template <class Derived>
Matrix3 nearest_rotation(const Eigen::MatrixBase<Derived>& m) {
  const Eigen::JacobiSVD<Matrix3, Eigen::NoQRPreconditioner> svd(Matrix3(m), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 signs = Vector3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// The rigid motion that best takes `from` to `to` in the least-squares sense, rows are points; never a reflection.
/// @param from n >= 1 points
/// @param to   where each of them should go
/// @throws std::invalid_argument when the numbers of points differ
/// @cite Kabsch 1976; Umeyama 1991
template <class From, class To>
Isometry3 register_points(const Eigen::MatrixBase<From>& from, const Eigen::MatrixBase<To>& to) {
  require(from.rows() == to.rows() && from.rows() >= 1, "register_points: ", from.rows(), " and ", to.rows(),
          " points");
  const Eigen::RowVector3d from_mean = from.colwise().mean(), to_mean = to.colwise().mean();
  Isometry3 out = Isometry3::Identity();
  out.linear() = nearest_rotation((to.rowwise() - to_mean).transpose() * (from.rowwise() - from_mean));
  out.translation() = to_mean.transpose() - out.linear() * from_mean.transpose();
  return out;
}

/// The fixed point from which points lie at given distances, by linear least squares on squared distances. Points on a
/// plane leave open on which side of it: then it lies on the plane.
/// @param points    n >= 1 rows
/// @param distances n values
/// @throws std::invalid_argument when the numbers differ
template <class Points, class Lengths>
Vector3 trilaterate(const Eigen::MatrixBase<Points>& points, const Eigen::MatrixBase<Lengths>& distances) {
  const Index n = points.rows();
  require(n == distances.size() && n >= 1, "trilaterate: ", n, " points, ", distances.size(), " distances");
  // |p - a|^2 = l^2 is linear in a and |a|^2; about the mean of the points the two come apart
  const Eigen::RowVector3d mean = points.colwise().mean();
  const PointRows centred = points.rowwise() - mean;
  const VectorX right = distances.array().square().matrix() - centred.rowwise().squaredNorm();
  Eigen::JacobiSVD<Matrix3, Eigen::NoQRPreconditioner> scatter(Matrix3(centred.transpose() * centred),
                                                               Eigen::ComputeFullU | Eigen::ComputeFullV);
  scatter.setThreshold(1e-12);
  return mean.transpose() - 0.5 * scatter.solve(centred.transpose() * right);
}

/// Base and tool frames that roughly explain the data, links nominal: the base by registering positions with the tool
/// point known so far, the tool point by linear least squares, in turns; the tool's rotation as the mean of what the
/// orientations ask for. A start for `identify`, which refines it.
/// @param model      the nominal arm
/// @param data       n >= 1 samples
/// @param base_guess the base where it is known
/// @param tool_guess first guess of the tool, or the tool where it is known
/// @param fit_base   whether the base may move
/// @param fit_tool   whether the tool may move
template <KinematicModel Model>
Framed<Model> starting_frames(const Model& model, const Dataset<Model::dof>& data, const Isometry3& base_guess,
                              const Isometry3& tool_guess, bool fit_base, bool fit_tool) {
  const Index n = data.size();
  require(n >= 1, "starting_frames: no samples");
  const std::vector<Isometry3> flanges = poses(model, data.joints());
  Isometry3 base = base_guess, tool = tool_guess;
  const auto flange = [&](Index i) -> const Isometry3& { return flanges[static_cast<std::size_t>(i)]; };
  for (int round = 0; round < 50; ++round) {
    const Isometry3 before = base;
    if (fit_base) {
      PointRows points(n, 3);
      for (Index i = 0; i < n; ++i) points.row(i) = (flange(i) * tool.translation()).transpose();
      base = register_points(points, data.positions());
    }
    if (!fit_tool) break;
    // base and flange rotate without stretching, so the least-squares tool point is a mean
    Vector3 sum = Vector3::Zero();
    for (Index i = 0; i < n; ++i)
      sum += flange(i).linear().transpose() *
             (base.linear().transpose() * (data.position(i) - base * flange(i).translation()));
    tool.translation() = sum / static_cast<double>(n);
    if (!fit_base || base.isApprox(before, 1e-12)) break;
  }
  if (fit_tool && data.has_orientations()) {
    Matrix3 sum = Matrix3::Zero();
    for (Index i = 0; i < n; ++i) sum += (base.linear() * flange(i).linear()).transpose() * data.orientation(i);
    tool.linear() = nearest_rotation(sum);
  }
  return Framed<Model>(model, base, tool);
}

/// The same from distances: the base as it is guessed, moved so that its origin is the fixed point; the tool as
/// guessed.
template <KinematicModel Model>
Framed<Model> starting_frames(const Model& model, const Distances<Model::dof>& data, const Isometry3& base_guess,
                              const Isometry3& tool_guess, bool fit_base, bool) {
  const Framed<Model> turned(model, Isometry3(base_guess.linear()), tool_guess);
  Isometry3 base = base_guess;
  if (fit_base) base.translation() = -trilaterate(positions(turned, data.joints()), data.lengths());
  return Framed<Model>(model, base, tool_guess);
}

}  // namespace vernier
