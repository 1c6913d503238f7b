// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/trilaterate.hpp"

namespace vernier {

VERNIER_IMPL Vector3 trilaterate(const PointRows& points, const VectorX& distances) {
  const Index n = points.rows();
  demand(n == distances.size() && n >= 1, "trilaterate: ", n, " points, ", distances.size(), " distances");
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
    const Vector3 axis = VERNIER_LATER(axes.vectors).col(k);
    out -= 0.5 * axis.dot(right) / axes.values(k) * axis;
  }
  return out;
}

}  // namespace vernier
