// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Frames behind the joints of a chain, which tilt or move.

#include "vernier/kinematics/detail/chain_table.hpp"
#include "vernier/kinematics/dh_chain.hpp"

namespace vernier::detail {

/// Joint axes, points on them, and the frames that tilt, of a chain at a configuration.
struct TiltingFrames {
  Vector3 axis[max_joints], point[max_joints], origin[max_joints];
  Vector3 x[max_joints], y[max_joints], z[max_joints];
};

/// The frames of a chain at a configuration.
VERNIER_API void find_tilting_frames(const ChainView& c, const double* q, TiltingFrames& out) noexcept;

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_terms/detail/tilting_frames.ipp"
#endif
