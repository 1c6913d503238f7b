// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/identification/detail/contact_frames.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<Index> frame_unknowns(const MeasuredSet& set) {
  std::vector<Index> out;
  for (Index k = 0; k < 6 && set.seen_from.rows() == 0; ++k)
    if (set.unknown_frame()[static_cast<std::size_t>(k)]) out.push_back(k);
  return out;
}

VERNIER_IMPL void require_spread(const ArmGeometry& arm, const MeasuredSet& set) {
  if (frame_unknowns(set) != std::vector<Index>{2, 3, 4}) return;  // no plane
  const PointRows points = arm.positions(set.joints);
  const MatrixX centred = VERNIER_LATER(rows_minus(points, column_means(points))).leftCols(2);
  const VectorX squares = symmetric_eigen(transposed_matrix_product(centred, centred)).values;
  const double width = std::sqrt((std::max)(squares(0), 0.0) / static_cast<double>(points.rows()));
  const double length = std::sqrt(squares(1) / static_cast<double>(points.rows()));
  demand(width > (std::max)(1e-3, 0.02 * length), set.name, ": all touches of the plane are along a line (",
         std::round(width * 1e4) / 10, " mm across, ", std::round(length * 1e4) / 10,
         " mm along), which does not determine its normal; spread them over the plane");
}

VERNIER_IMPL MatrixX touching_joints(const ArmGeometry& arm, const MeasuredSet& set) {
  MatrixX joints = set.joints;
  PosesAndJacobians at;
  const Index n = joints.rows(), dof = joints.cols(), values = set.values();
  SensedRows sensed;
  for (int iteration = 0; iteration < 6; ++iteration) {
    arm.poses_and_parameter_jacobians(joints, at);
    for (Index i = 0; i < n; ++i) {
      set.sense(i, at.poses[static_cast<std::size_t>(i)], sensed);
      MatrixX rows = MatrixX::Zero(values, dof);
      for (int j = 0; j < static_cast<int>(dof); ++j) {  // a joint adds to a parameter of its row
        const Index k = arm.joint_parameter(j);
        for (Index c = 0; c < 6; ++c)
          for (Index r = 0; r < values; ++r)
            rows(r, j) += sensed.motion(r, c) * at.jacobians.data()[(6 * k + c) * n + i];
      }
      VectorX residual = VERNIER_LATER(sensed.residual).head(values);
      MatrixX gram = matrix_product(rows, VERNIER_LATER(rows).transpose());
      const double least = 1e-12 * rows.squaredNorm();
      for (Index k = 0; k < gram.cols(); ++k) gram(k, k) += least;
      solve_general(gram, residual);
      const VectorX step = transposed_product(rows, residual);
      if (step.norm() < 0.5)  // so finite
        for (Index j = 0; j < dof; ++j) joints(i, j) -= step(j);
    }
  }
  return joints;
}

}  // namespace vernier::detail
