// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Closed-form inverse kinematics of six revolute joints, from the lines of their axes.

#include "vernier/kinematics/detail/six_axes.hpp"
#include "vernier/kinematics/detail/wrist.hpp"
#include "vernier/kinematics/singularities.hpp"

namespace vernier::detail {

/// What closed forms there are: axes of an arm, or of its mirror image (from the tool to the base), counted from 1.
enum class ArmKind {
  second_parallel_to_third,  ///< and a spherical wrist
  first_parallel_to_second,  ///< and a spherical wrist
  first_meets_second,        ///< and a spherical wrist
  second_meets_third,        ///< and a spherical wrist
  three_parallel,            ///< 2, 3 and 4 parallel; 5 meets 6
};

/// The closed form of one arm.
class ClosedFormArm {
 public:
  /// @param axes      of the nominal arm
  /// @param tolerance within which axes count as parallel [rad] or meeting [m]
  /// @throws std::invalid_argument that says what keeps the arm out of each family
  VERNIER_API ClosedFormArm(const SixAxes& axes, double tolerance);

  ArmKind kind() const { return kind_; }
  bool mirrored() const { return mirrored_; }
  const SixAxes& axes() const { return axes_; }

  /// Roots with a margin of at most 5 %.
  /// @param target base_T_tool, a proper rigid motion
  /// @param close_to   six values that joints take whose value makes no difference [rad]
  /// @param width  [m, rad] so near to a singularity of shoulder or wrist samples of the joint whose value hardly
  /// matters are added, with a margin
  VERNIER_API SixAxisRoots solve(const Isometry3& target, const JointVector<6>& close_to,
                                 double width = 0) const noexcept;

  /// Distances from the singularities at joint values.
  VERNIER_API SingularityDistances distances(const JointVector<6>& q) const noexcept;

 private:
  SixAxes axes_;
  bool mirrored_;
  ArmKind kind_;
  Vector3 h_[6], o_[6], p_[6];     ///< directions, points, and from one point to the next; mirrored where the arm is
  double third_ = 1, fourth_ = 1;  ///< signs of axes 3 and 4 along axis 2
  Wrist wrist_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/closed_form_arm.ipp"
#endif
