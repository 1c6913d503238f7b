// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/register_points.hpp"

#include <Eigen/LU>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier {

VERNIER_IMPL Matrix3 nearest_rotation(const Matrix3& matrix) {
  const detail::ThinSvd svd = detail::thin_svd(matrix);
  Matrix3 left = svd.u;
  const Matrix3 right = svd.v, back = VERNIER_LATER(right).transpose(), nearest = left * back;
  if (!(nearest.determinant() < 0)) return nearest;
  for (Index r = 0; r < 3; ++r) left(r, 2) = -left(r, 2);
  return left * back;
}

VERNIER_IMPL Isometry3 register_points(const PointRows& from, const PointRows& to) {
  demand(from.rows() == to.rows() && from.rows() >= 1, "register_points: ", from.rows(), " and ", to.rows(), " points");
  const Vector3 from_mean = centroid(from), to_mean = centroid(to);
  Matrix3 sum = Matrix3::Zero();
  for (Index i = 0; i < from.rows(); ++i) {
    const Vector3 a = point(from, i) - from_mean, b = point(to, i) - to_mean;
    for (Index c = 0; c < 3; ++c)
      for (Index r = 0; r < 3; ++r) sum(r, c) += b(r) * a(c);
  }
  const Matrix3 turn = nearest_rotation(sum);
  const Vector3 turned = turn * from_mean;
  return rigid_motion(turn, to_mean - turned);
}

}  // namespace vernier
