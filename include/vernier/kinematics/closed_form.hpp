// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Closed-form inverse kinematics of nominal arms: all joint values that bring the tool to a pose.

#include <algorithm>
#include <array>
#include <concepts>

#include "vernier/core/check.hpp"
#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/kinematics/detail/closed_form_arm.hpp"
#include "vernier/kinematics/detail/six_axes.hpp"
#include "vernier/kinematics/detail/subproblems.hpp"
#include "vernier/kinematics/singularities.hpp"

namespace vernier {

/// A joint that is held, so that six of seven move.
struct HeldJoint {
  int joint;         ///< counted from 0
  double value = 0;  ///< [rad], or [m] of a prismatic joint, e.g. a rail
};

/// Joint values of one target.
template <int N>
struct InverseRoot {
  JointVector<N> joints;  ///< each moving joint in (-pi, pi] [rad]
  double margin;  ///< 0; positive where the target is out of reach: its relative distance from a boundary of the
                  ///< arm, whose joint values these are
  unsigned free;  ///< bit i: the value of joint i is arbitrary there (a singularity), others follow from it
  bool sampled;   ///< a sample around the singularity of a spherical wrist, see `ClosedForm::roots`
};

/// All joint values of one target; a range of `InverseRoot`.
template <int N>
struct InverseRoots {
  std::array<InverseRoot<N>, detail::SixAxisRoots::capacity> roots;  ///< the first `count` are set
  int count = 0;                                                     ///< number of roots
  /// The smallest margin of a root that was left out because it exceeds 5 %; infinite where there was none.
  double nearest_margin = std::numeric_limits<double>::infinity();
  double condition = 1;  ///< of the linear algebra; 1 for closed forms

  /// The first root.
  const InverseRoot<N>* begin() const { return roots.data(); }
  /// Behind the last root.
  const InverseRoot<N>* end() const { return roots.data() + count; }
};

namespace detail {

/// The six moving joints of an arm of N.
template <int N>
struct MovingJoints {
  std::array<int, 6> index{};  ///< of each
  HeldJoint held{-1, 0};       ///< the other one

  explicit MovingJoints(HeldJoint of) : held(of) {
    for (int i = 0, k = 0; i < N && k < 6; ++i)
      if (i != held.joint) index[static_cast<std::size_t>(k++)] = i;
  }
  JointVector<6> of(const JointVector<N>& q) const noexcept {
    JointVector<6> out;
    for (int k = 0; k < 6; ++k) out(k) = q(index[static_cast<std::size_t>(k)]);
    return out;
  }
  InverseRoots<N> around(const SixAxisRoots& from) const noexcept {
    InverseRoots<N> out;
    out.count = from.count;
    out.nearest_margin = from.nearest_margin;
    out.condition = from.condition;
    for (int r = 0; r < from.count; ++r) {
      const SixAxisRoot& root = from.roots[static_cast<std::size_t>(r)];
      InverseRoot<N>& to = out.roots[static_cast<std::size_t>(r)];
      to.margin = root.margin;
      to.free = 0;
      to.sampled = root.sampled;
      if (held.joint >= 0) to.joints(held.joint) = held.value;
      for (int k = 0; k < 6; ++k) {
        const int joint = index[static_cast<std::size_t>(k)];
        to.joints(joint) = root.joints(k);
        if ((root.free >> k & 1u) != 0) to.free |= 1u << joint;
      }
    }
    return out;
  }
};

/// The axes of all joints of an arm at joint values.
/// @param held the joint that does not move, counted from 0; -1: none
/// @throws std::invalid_argument for prismatic joints that move
template <NominalArm Arm>
ArmAxes arm_axes(const Arm& arm, const JointVector<Arm::dof>& q = JointVector<Arm::dof>::Zero(), int held = -1) {
  const auto framed = in_frames(arm);
  const auto& chain = framed.model();
  for (int i = 0; i < Arm::dof; ++i)
    demand(i == held || chain.row(i).joint == JointType::revolute, "ClosedForm: joint ", i + 1, " is prismatic");
  const auto links = chain.links(q);
  ArmAxes out;
  out.joints = Arm::dof;
  out.tool = framed.pose(q);
  const Matrix3 turn = rotation(framed.base());
  for (int i = 0; i < Arm::dof; ++i) {
    out.direction[i] = rotated(turn, {links.axis(0, i), links.axis(1, i), links.axis(2, i)});
    out.point[i] = transformed(framed.base(), {links.point(0, i), links.point(1, i), links.point(2, i)});
  }
  return out;
}

/// The axes of an arm's moving joints.
/// @throws std::invalid_argument for a held joint that the arm does not have, and for prismatic joints that move
template <NominalArm Arm>
SixAxes six_axes_of(const Arm& arm, const HeldJoint& held) {
  constexpr int N = Arm::dof;
  static_assert(N == 6 || N == 7, "closed forms move six joints; of seven, one is held");
  demand(N == 6 ? held.joint < 0 : held.joint >= 0 && held.joint < N, "ClosedForm: no joint ", held.joint + 1,
         " to be held");
  JointVector<N> q = JointVector<N>::Zero();
  if (held.joint >= 0) q(held.joint) = held.value;
  const ArmAxes all = arm_axes(arm, q, held.joint);
  SixAxes out;
  const MovingJoints<N> moving(held);
  for (int k = 0; k < 6; ++k) {
    const int i = moving.index[static_cast<std::size_t>(k)];
    for (int c = 0; c < 3; ++c) {
      out.direction(c, k) = all.direction[i](c);
      out.point(c, k) = all.point[i](c);
    }
  }
  out.tool = all.tool;
  return out;
}

}  // namespace detail

/// The closed form of a nominal arm of six revolute joints, or of seven with one held, which may be a rail; its base
/// and tool frames are included. The arm has a spherical wrist (or, mirrored, a spherical shoulder) and two parallel or
/// meeting neighbours among its other three axes; or three parallel axes in its middle, the last two meeting (or,
/// mirrored, the first two).
///
///     const ClosedForm closed_form(robots::ur10().chain);
///     for (const auto& root : closed_form.roots(target)) use(root.joints);
///
/// An arm whose parameters are identified has none; `all_branches` starts from that of the nominal one.
/// @cite Pieper 1968; Elias and Wen 2025
template <int N>
class ClosedForm : public ChecksJoints<ClosedForm<N>> {
  using Checks = ChecksJoints<ClosedForm>;

 public:
  using Checks::distances;
  using Checks::roots;

  /// Number of joints.
  static constexpr int dof = N;

  /// @param nominal   `DhChain`, or one between frames; not an identified one
  /// @param tolerance within which axes count as parallel [rad] or meeting [m]
  /// @throws std::invalid_argument that says what keeps the arm out of each family
  template <NominalArm Arm>
    requires(N == 6 && Arm::dof == 6)
  explicit ClosedForm(const Arm& nominal, double tolerance = 1e-6)
      : moving_(HeldJoint{-1, 0}),
        arm_(detail::six_axes_of(nominal, moving_.held), tolerance),
        length_(detail::arm_length(detail::arm_axes(nominal))) {}
  /// The closed form of an arm with seven joints, one of them held.
  template <NominalArm Arm>
    requires(N == 7 && Arm::dof == 7)
  ClosedForm(const Arm& nominal, HeldJoint held, double tolerance = 1e-6)
      : moving_(held),
        arm_(detail::six_axes_of(nominal, held), tolerance),
        length_(detail::arm_length(detail::arm_axes(nominal, JointVector<N>::Zero(), held.joint))) {}

  /// All joint values with which the nominal arm is at a pose; does not allocate.
  /// @param target base_T_tool, a proper rigid motion
  /// @param close_to   values of joints whose value is arbitrary in a singularity [rad]
  /// @param width  [m, rad] where the target is so near to a singularity of shoulder or wrist, samples of the joint
  /// whose value hardly matters are added, with a positive margin: seeds for an arm that is not quite the nominal one
  /// @complexity   about 2 us
  InverseRoots<N> roots(const Isometry3& target, const JointVector<N>& close_to = JointVector<N>::Zero(),
                        double width = 0) const noexcept {
    return moving_.around(arm_.solve(target, moving_.of(close_to), width));
  }

  /// How far joint values are from singularities, and on which side of them: the branch.
  SingularityDistances distances(const JointVector<N>& q) const noexcept { return arm_.distances(moving_.of(q)); }

  /// The joint that is held; -1 where all move.
  int held_joint() const { return moving_.held.joint; }
  /// Whether it is solved from the tool to the base.
  bool mirrored() const { return arm_.mirrored(); }
  /// Sum of the lengths of its links [m].
  double arm_length() const { return length_; }

 private:
  detail::MovingJoints<N> moving_;
  detail::ClosedFormArm arm_;
  double length_;
};

/// Joint values of a nominal arm at a pose: what `all_branches` starts from. `ClosedForm`, `ArmAngleForm` and
/// `GeneralSixAxis` are such.
///
/// - `roots(target, near, width)`, `distances(q)`, `held_joint()`, `arm_length()`: see `ClosedForm`
template <class S>
concept BranchRoots = requires(const S& solver, const Isometry3& target, const JointVector<S::dof>& q) {
  { solver.roots(target, q, 0.0) }
  noexcept->std::same_as<InverseRoots<S::dof>>;
  { solver.distances(q) }
  noexcept->std::same_as<SingularityDistances>;
  { solver.held_joint() } -> std::convertible_to<int>;
  { solver.arm_length() } -> std::convertible_to<double>;
};

/// Of six joints.
template <NominalArm Arm>
ClosedForm(const Arm&, double = 0) -> ClosedForm<Arm::dof>;
/// Of seven, one of them held.
template <NominalArm Arm>
ClosedForm(const Arm&, HeldJoint, double = 0) -> ClosedForm<Arm::dof>;

}  // namespace vernier
