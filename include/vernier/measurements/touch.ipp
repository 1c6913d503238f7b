// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/measurements/touch.hpp"

namespace vernier::detail {

VERNIER_IMPL Matrix3 rotation_to_z(const Vector3& direction) {
  const Vector3 axis = direction.cross(Vector3::UnitZ());
  const double sine = axis.norm();
  if (sine > 0) return exp_so3(Vector3(axis * (std::atan2(sine, direction.z()) / sine)));
  Matrix3 out = Matrix3::Identity();
  if (direction.z() < 0) out(1, 1) = out(2, 2) = -1;  // half a turn about x
  return out;
}

VERNIER_IMPL Vector3 rise_of(const PointRows& points, const VectorX& heights) {
  Vector3 out = Vector3::Zero();
  const Vector3 middle = centroid(points);
  const double mean = heights.mean();
  for (Index i = 0; i < points.rows(); ++i) {
    const Vector3 from_middle = point(points, i) - middle;
    out += (heights(i) - mean) * from_middle;
  }
  return out;
}

VERNIER_IMPL Vector3 fitted_normal(const PointRows& points, const VectorX& heights) {
  MatrixX from_means(points.rows(), 3);
  for (Index i = 0; i < points.rows(); ++i) {
    Vector3 sum = Vector3::Zero();  // of the face that i is on
    double count = 0;
    for (Index k = 0; k < points.rows(); ++k)
      if (same_value(heights(k), heights(i))) {
        sum += point(points, k);
        ++count;
      }
    for (Index c = 0; c < 3; ++c) from_means(i, c) = points(i, c) - sum(c) / count;
  }
  const Vector3 normal = symmetric_eigen(transposed_matrix_product(from_means, from_means)).vectors.col(0);
  return normal.dot(rise_of(points, heights)) < 0 ? Vector3(-normal) : normal;
}

}  // namespace vernier::detail
