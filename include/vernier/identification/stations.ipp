#pragma once

#include "vernier/core/so3.hpp"
#include "vernier/identification/stations.hpp"

namespace vernier::detail {

VERNIER_IMPL void move_poses(const Isometry3& motion, const PointRows& positions, const PointRows& orientations,
                             Index first, PointRows& moved_positions, PointRows& moved_orientations) {
  for (Index i = 0; i < positions.rows(); ++i) {
    moved_positions.row(first + i) = (motion * Vector3(positions.row(i).transpose())).transpose();
    if (moved_orientations.rows() > 0)
      moved_orientations.row(first + i) =
          log_so3(motion.linear() * exp_so3(Vector3(orientations.row(i).transpose()))).transpose();
  }
}

}  // namespace vernier::detail
