// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/identification/in_one_frame.hpp"

namespace vernier::detail {

VERNIER_IMPL Matrix6 turned_covariance(const Isometry3& motion, const Matrix6& covariance) {
  Matrix6 turn = Matrix6::Zero();
  for (Index c = 0; c < 3; ++c)
    for (Index r = 0; r < 3; ++r) turn(r, c) = turn(r + 3, c + 3) = motion(r, c);
  const Matrix6 half = turn * covariance;
  return half * VERNIER_LATER(turn).transpose();
}

VERNIER_IMPL void move_poses(const Isometry3& motion, const PointRows& positions, const PointRows& orientations,
                             Index first, PointRows& moved_positions, PointRows& moved_orientations) {
  const Matrix3 turn = rotation(motion);
  for (Index i = 0; i < positions.rows(); ++i) {
    set_point(moved_positions, first + i, transformed(motion, point(positions, i)));
    if (moved_orientations.rows() > 0)
      set_point(moved_orientations, first + i, log_so3(turn * exp_so3(point(orientations, i))));
  }
}

}  // namespace vernier::detail
