#pragma once

#include "vernier/core/register_points.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "vernier/core/check.hpp"

namespace vernier {

VERNIER_IMPL Matrix3 nearest_rotation(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3, Eigen::NoQRPreconditioner> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

VERNIER_IMPL Isometry3 register_points(const PointRows& from, const PointRows& to) {
  require(from.rows() == to.rows() && from.rows() >= 1, "register_points: ", from.rows(), " and ", to.rows(),
          " points");
  const Vector3 from_mean = from.colwise().mean().transpose(), to_mean = to.colwise().mean().transpose();
  Matrix3 sum = Matrix3::Zero();
  for (Index i = 0; i < from.rows(); ++i)
    sum += (to.row(i).transpose() - to_mean) * (from.row(i).transpose() - from_mean).transpose();
  Isometry3 out = Isometry3::Identity();
  out.linear() = nearest_rotation(sum);
  out.translation() = to_mean - out.linear() * from_mean;
  return out;
}

}  // namespace vernier
