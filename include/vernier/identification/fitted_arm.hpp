// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An arm in frames with joint errors, whose number of joints is known at run time.

#include "vernier/error_terms/joint_errors.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// What `Framed<WithJointErrors<DhChain<N, Convention>>>` is for a number of joints known at compile time.
struct FittedArm {
  ArmGeometry geometry;  ///< chain and frames
  JointErrors errors;    ///< of the joints; may be empty

  /// The fitted arm with the type of the robot.
  template <class Chain>
  Framed<WithJointErrors<Chain>> typed(const Chain& like) const {
    const Framed<Chain> arm = geometry.framed(like);
    return arm.around(WithJointErrors<Chain>(arm.model(), errors));
  }
  /// This arm with the hysteresis of another in place of its own.
  VERNIER_API FittedArm with_hysteresis_of(const FittedArm& other) const;

  /// A fitted arm without the type of its robot.
  template <class Chain>
  static FittedArm of(const Framed<WithJointErrors<Chain>>& arm) {
    return {ArmGeometry(arm.around(arm.chain())), arm.model().joint_errors()};
  }
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/fitted_arm.ipp"
#endif
