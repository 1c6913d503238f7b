// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Closed-form inverse kinematics of arms of seven joints at a given arm angle.

#include "vernier/core/checked_joints.hpp"
#include "vernier/kinematics/closed_form.hpp"
#include "vernier/kinematics/detail/spherical_arm.hpp"

namespace vernier {

/// The closed form of a nominal arm of seven revolute joints whose first three axes meet in a shoulder and whose last
/// three in a wrist, with the elbow turned about the line between them by a given arm angle. An offset of the elbow is
/// allowed, if it lies in the plane of shoulder, elbow and wrist.
///
///     const ArmAngleForm closed_form(robots::barrett_wam().chain, 0.4);
///     for (const auto& root : closed_form.roots(target)) use(root.joints);
///
/// The arm angle is that of the axis of joint 4 about the line from shoulder to wrist, 0 where that axis is at right
/// angles to the first one, in the direction (axis 1) x (wrist - shoulder): where joint 3 is zero and joint 2
/// positive, in the usual conventions. Where the wrist lies on axis 1 it is measured from axis 2 at joint values zero.
/// @cite Shimizu et al. 2008
class ArmAngleForm : public ChecksJoints<ArmAngleForm> {
  using Checks = ChecksJoints<ArmAngleForm>;

 public:
  using Checks::distances;
  using Checks::roots;

  /// Number of joints.
  static constexpr int dof = 7;

  /// @param nominal   `DhChain`, or one between frames; not an identified one
  /// @param arm_angle [rad]
  /// @param tolerance within which axes count as meeting [m]
  /// @throws std::invalid_argument that says what keeps the arm from having this closed form
  template <NominalArm Arm>
    requires(Arm::dof == 7)
  ArmAngleForm(const Arm& nominal, double arm_angle, double tolerance = 1e-6)
      : arm_(detail::arm_axes(nominal), tolerance),
        angle_(arm_angle),
        length_(detail::arm_length(detail::arm_axes(nominal))) {
    demand(std::isfinite(arm_angle), "ArmAngleForm: the arm angle is ", arm_angle);
  }

  /// This arm's solutions at another arm angle [rad].
  ArmAngleForm at(double arm_angle) const {
    ArmAngleForm out = *this;
    out.angle_ = arm_angle;
    return out;
  }
  /// The arm angle of the nominal arm at joint values, in (-pi, pi] [rad].
  VERNIER_API double arm_angle(const JointVector<7>& q) const noexcept { return arm_.arm_angle(q); }

  /// All joint values with which the nominal arm is at a pose; see `ClosedForm::roots`. None where the wrist is in the
  /// shoulder.
  VERNIER_API InverseRoots<7> roots(const Isometry3& target, const JointVector<7>& close_to = JointVector<7>::Zero(),
                                    double width = 0) const noexcept {
    const detail::SphericalArmRoots from = arm_.solve(target, angle_, close_to, width);
    InverseRoots<7> out;
    out.count = from.count;
    out.nearest_margin = from.nearest_margin;
    for (int r = 0; r < from.count; ++r) {
      const detail::SphericalArmRoot& root = from.roots[static_cast<std::size_t>(r)];
      out.roots[static_cast<std::size_t>(r)] = {root.joints, root.margin, root.free, root.sampled};
    }
    return out;
  }
  /// Sines of the angles between the first and third, and the fifth and seventh axis, and of the elbow.
  VERNIER_API SingularityDistances distances(const JointVector<7>& q) const noexcept { return arm_.distances(q); }
  /// The joint that `all_branches` leaves at its value of the nominal arm: the third.
  int held_joint() const { return 2; }
  /// Sum of the lengths of its links [m].
  double arm_length() const { return length_; }

 private:
  detail::SphericalArm arm_;
  double angle_;
  double length_;
};

}  // namespace vernier
