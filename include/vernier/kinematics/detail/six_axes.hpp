// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A six-axis arm by the lines of its joint axes, and the joint values that a solver of such arms finds.

#include <array>
#include <limits>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Six revolute joints by the lines of their axes at joint values zero, in the frame in which targets are given. Any
/// convention of link frames leads to this.
struct SixAxes {
  Eigen::Matrix<double, 3, 6> direction;  ///< unit vectors; the joint turns about it by the right-hand rule
  Eigen::Matrix<double, 3, 6> point;      ///< a point on each axis [m]
  Isometry3 tool;                         ///< base_T_tool at joint values zero

  Vector3 direction_of(int i) const { return {direction(0, i), direction(1, i), direction(2, i)}; }
  Vector3 point_of(int i) const { return {point(0, i), point(1, i), point(2, i)}; }
};

/// Axes of an arm of 6 or 7 revolute joints, and its tool at joint values zero.
struct ArmAxes {
  int joints;
  Vector3 direction[7], point[7];  ///< of each
  Isometry3 tool;
};

/// base_T_tool at joint values: the product of exponentials.
/// @cite Brockett 1984; Lynch and Park 2017
VERNIER_API Isometry3 pose_of(const SixAxes& arm, const JointVector<6>& q) noexcept;

/// Bound of the distance of the tool from any axis point, in every configuration [m].
VERNIER_API double arm_length(const ArmAxes& arm) noexcept;
VERNIER_API double arm_length(const SixAxes& arm) noexcept;
/// By how much a target lies farther away than the arm is long [m]; negative where it may be within reach.
VERNIER_API double reach_excess(const ArmAxes& arm, const Isometry3& target) noexcept;

/// Joint values that a solver found.
struct SixAxisRoot {
  JointVector<6> joints;  ///< [rad], each in (-pi, pi]
  /// By how much the target lies beyond a boundary of the arm, relative to that boundary: 0 for a root, positive for
  /// the joint values at the boundary that come nearest.
  double margin = 0;
  unsigned free = 0;     ///< bit i: every value of joint i would do as well, given that others follow
  bool sampled = false;  ///< one of several next to a singularity of the shoulder, elbow or wrist
};

/// All joint values that a solver found for one target.
struct SixAxisRoots {
  /// A six-axis arm has at most 16 solutions (@cite Primrose 1986); the others are for samples near singularities.
  static constexpr int capacity = 128;
  std::array<SixAxisRoot, capacity> roots;  ///< the first `count` are set
  int count = 0;                            ///< how many were found
  /// The smallest margin of what was left out because its own was too large; infinite where there was nothing such.
  double nearest_margin = std::numeric_limits<double>::infinity();
  double condition = 1;  ///< of the linear algebra that found them; 1 for closed forms

  const SixAxisRoot* begin() const { return roots.data(); }
  const SixAxisRoot* end() const { return roots.data() + count; }
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/six_axes.ipp"
#endif
