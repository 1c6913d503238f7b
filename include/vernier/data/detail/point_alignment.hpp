// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The parts of pairing points with poses: frames from pairs, and alignment with gaps.

#include <span>
#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/data/point_pair.hpp"

namespace vernier::detail {

/// Where the nominal arm stands, and where the reflector is on its flange.
struct PointFrames {
  Isometry3 base = Isometry3::Identity();  ///< in the frame of the points
  Vector3 offset = Vector3::Zero();        ///< in the frame of the flange [m]
  double rms = 0;                          ///< distance, corrected for nine unknowns [m]

  /// Where a reflector on this flange is.
  Vector3 point(const Isometry3& flange) const { return transformed(base, transformed(flange, offset)); }
};

/// The frames with the smallest sum of squared distances of at least six pairs: Gauss-Newton from two closed forms, the
/// affine map (in which rotation, translation and offset are linear) and rigid registration without an offset. An
/// offset that the orientations do not determine is small.
/// @param max_steps of Gauss-Newton; few suffice to see whether pairs belong together
VERNIER_API PointFrames fit_point_frames(std::span<const Isometry3> flanges, const PointRows& points,
                                         std::span<const PointPair> pairs, int max_steps = 20);

/// The pairs in ascending rows and points with the smallest sum of costs, where each row and each point without a
/// partner costs 1/2. Pairs of cost 1 or more are not made.
/// @complexity O(rows x points) time, and a byte each
VERNIER_API std::vector<PointPair> align_with_gaps(Index rows, Index points, FunctionRef<double(Index, Index)> cost);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/data/detail/point_alignment.ipp"
#endif
