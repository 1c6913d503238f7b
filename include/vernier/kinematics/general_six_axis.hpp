// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Inverse kinematics of nominal arms of any geometry: the second line behind closed forms.

#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/detail/general_six_axis.hpp"

namespace vernier {

/// Joint values of a nominal arm of six revolute joints, or of seven with one held, whose axes lie anyhow. Fifty times
/// slower than a `ClosedForm`, for arms that have none (offset wrists), and used like one.
///
/// The `condition` of its roots tells how well the elimination was conditioned; above 1e6 it was repeated with other
/// joints eliminated. One of two roots may be lost within about 1e-4 rad of each other.
/// @cite Raghavan and Roth 1993; Manocha and Canny 1994
template <int N>
class GeneralSixAxis : public ChecksJoints<GeneralSixAxis<N>> {
  using Checks = ChecksJoints<GeneralSixAxis>;

 public:
  using Checks::distances;
  using Checks::roots;

  /// Number of joints.
  static constexpr int dof = N;

  /// @param nominal `DhChain`, or one between frames
  /// @throws std::invalid_argument for a prismatic joint
  template <NominalArm Arm>
    requires(N == 6 && Arm::dof == 6)
  explicit GeneralSixAxis(const Arm& nominal)
      : moving_(HeldJoint{-1, 0}),
        axes_(detail::six_axes_of(nominal, moving_.held)),
        length_(detail::arm_length(detail::arm_axes(nominal))) {}
  /// The branches of an arm with seven joints, one of them held.
  template <NominalArm Arm>
    requires(N == 7 && Arm::dof == 7)
  GeneralSixAxis(const Arm& nominal, HeldJoint held)
      : moving_(held),
        axes_(detail::six_axes_of(nominal, held)),
        length_(detail::arm_length(detail::arm_axes(nominal, JointVector<N>::Zero(), held.joint))) {}

  /// All joint values with which the nominal arm is at a pose. Does not allocate.
  /// @param target base_T_tool, a proper rigid motion
  /// @complexity   0.1 to 1 ms
  InverseRoots<N> roots(const Isometry3& target, const JointVector<N>& = JointVector<N>::Zero(),
                        double = 0) const noexcept {
    return moving_.around(detail::solve_six_axes(axes_, target));
  }
  /// The determinant of the Jacobian, see `SingularityDistances::factored`.
  SingularityDistances distances(const JointVector<N>& q) const noexcept {
    return detail::unfactored_distance(axes_, moving_.of(q));
  }
  /// The joint that is held; -1 where all move.
  int held_joint() const { return moving_.held.joint; }
  /// Sum of the lengths of its links [m].
  double arm_length() const { return length_; }

 private:
  detail::MovingJoints<N> moving_;
  detail::SixAxes axes_;
  double length_;
};

/// Of six joints.
template <NominalArm Arm>
GeneralSixAxis(const Arm&) -> GeneralSixAxis<Arm::dof>;
/// Of seven, one of them held.
template <NominalArm Arm>
GeneralSixAxis(const Arm&, HeldJoint) -> GeneralSixAxis<Arm::dof>;

}  // namespace vernier
