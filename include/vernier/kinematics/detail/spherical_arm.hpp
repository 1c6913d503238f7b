// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Closed-form inverse kinematics of seven joints with a spherical shoulder and a spherical wrist, at a given arm
/// angle.

#include <array>
#include <limits>

#include "vernier/kinematics/detail/six_axes.hpp"
#include "vernier/kinematics/detail/wrist.hpp"
#include "vernier/kinematics/singularities.hpp"

namespace vernier::detail {

/// Joint values of such an arm, see `SixAxisRoot`.
struct SphericalArmRoot {
  JointVector<7> joints;
  double margin;
  unsigned free;
  bool sampled;
};

/// All of one target.
struct SphericalArmRoots {
  static constexpr int capacity = SixAxisRoots::capacity;
  std::array<SphericalArmRoot, capacity> roots;
  int count = 0;
  double nearest_margin = std::numeric_limits<double>::infinity();
};

/// The closed form of one arm.
class SphericalArm {
 public:
  /// @param axes      of the nominal arm at joint values zero
  /// @param tolerance within which axes count as meeting [m]
  /// @throws std::invalid_argument that says what keeps the arm out of the family
  VERNIER_API SphericalArm(const ArmAxes& axes, double tolerance);

  /// Roots with a margin of at most 5 %.
  /// @param target base_T_tool, a proper rigid motion
  /// @param angle  of the arm [rad]
  /// @param close_to   values that joints take whose value makes no difference [rad]
  /// @param width  [rad] so near to the straight wrist samples of joint 5 are added, with a margin
  VERNIER_API SphericalArmRoots solve(const Isometry3& target, double angle, const JointVector<7>& close_to,
                                      double width) const noexcept;
  /// The arm angle at joint values, in (-pi, pi] [rad].
  VERNIER_API double arm_angle(const JointVector<7>& q) const noexcept;
  /// Distances from the singularities at joint values.
  VERNIER_API SingularityDistances distances(const JointVector<7>& q) const noexcept;

 private:
  /// The direction of axis 4 at arm angle zero, for a wrist centre in a direction from the shoulder.
  VERNIER_API Vector3 reference(const Vector3& to_wrist) const noexcept;

  ArmAxes axes_;
  Vector3 shoulder_, wrist_;      ///< points in which three axes meet, at joint values zero
  Vector3 axis4_, upper_, fore_;  ///< direction of axis 4; from the shoulder to a point on it, from there to the wrist
  Wrist first_, last_;            ///< the joints of shoulder and wrist
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/spherical_arm.ipp"
#endif
