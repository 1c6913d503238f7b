// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Small changes of base, joint zeros and tool of a fitted arm, and what they do to a pose.

#include "vernier/core/types.hpp"
#include "vernier/least_squares/row_block.hpp"

namespace vernier {

/// How an arm was moved, and how the probe that measures orientations is turned against its tool.
struct FrameMotion {
  Isometry3 base = Isometry3::Identity();  ///< applied before the base frame: new base = motion * old base
  VectorX offsets{};                       ///< added to the joint zeros [rad, m]
  Isometry3 tool = Isometry3::Identity();  ///< applied after the tool frame: new tool = old tool * motion
  /// Rotation vector in the tool frame [rad]: measured orientation = orientation of the tool * exp(probe). Positions do
  /// not depend on it, and the model's tool is not turned.
  Vector3 probe = Vector3::Zero();
};

namespace detail {

/// Which changes are estimated: of the base (a twist in the outer frame), of the joint zeros, of the tool (a twist in
/// its own frame), of the probe (a rotation in the tool's frame).
struct FrameUpdate {
  bool base, offsets, tool;
  int joints;
  bool probe = false;

  Index size() const { return probe_begin() + (probe ? 3 : 0); }
  /// First column of the joint zeros.
  Index offsets_begin() const { return base ? 6 : 0; }
  /// First column of the tool.
  Index tool_begin() const { return offsets_begin() + (offsets ? joints : 0); }
  /// First column of the probe.
  Index probe_begin() const { return tool_begin() + (tool ? 6 : 0); }
  /// Effect of unit changes on a pose, 6 x size.
  /// @param jacobian 6 x joints
  VERNIER_API Rows6 columns(const Isometry3& pose, const double* jacobian) const;
  /// A motion followed by a change.
  VERNIER_API FrameMotion apply(const FrameMotion& before, const VectorX& change) const;
  /// A motion by a change alone.
  VERNIER_API FrameMotion motion(const VectorX& change) const;
};

}  // namespace detail
}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/registration/frame_update.ipp"
#endif
