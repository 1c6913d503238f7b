// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Fitted corrections of an arm's commands.

#include <concepts>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace vernier {

/// A corrected command and its predicted error.
template <int N>
struct Correction {
  JointVector<N> command;      ///< joints to send to the arm [rad, m]
  IkStatus status;             ///< converged, or why the target is not met
  double predicted_error = 0;  ///< distance from the target that the model predicts for `command` [m]
  double gate =
      1;  ///< share of the learned correction that was used: 1 inside the measured joint ranges, 0 far outside
};

/// A model of the actual poses of an arm and a correction of its commands. No call allocates or throws.
///
/// - `predict(q)`: the pose the arm takes when commanded q
/// - `correct(q)`: the command that brings it to the pose of the nominal arm at q
template <class C>
concept Compensator = requires(const C& compensator, const JointVector<C::dof>& q) {
  { compensator.predict(q) }
  noexcept->std::same_as<Isometry3>;
  { compensator.correct(q) }
  noexcept->std::same_as<Correction<C::dof>>;
};

/// Target of a correction.
enum class CorrectionTarget {
  automatic,  ///< the full pose for six joints or more, else the position
  pose,       ///< position and orientation
  position,   ///< the position alone, the orientation is free (the paper's mode)
};

/// How commands are corrected.
struct CorrectionOptions {
  /// Target of a correction.
  CorrectionTarget target = CorrectionTarget::automatic;
  int moving_joints = 0;             ///< number of joints corrected, from the base; 0: all (the paper moves 3)
  double position_tolerance = 1e-6;  ///< the paper's epsilon [m]
  double rotation_tolerance = 1e-6;  ///< [rad]
  int max_iterations = 30;           ///< evaluations of the model

  /// @param dof number of joints
  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate(int dof) const;
};

namespace detail {

/// Throws `std::invalid_argument` where a model and its data are more than 50 mm apart on average: their frames differ.
/// @param error of the positions [m]
VERNIER_API void require_same_frames(const char* caller, const PointRows& error);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/compensation/concepts.ipp"
#endif
