#pragma once

/// @file
/// Fitted corrections of an arm's commands.

#include <concepts>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/inverse_kinematics.hpp"

namespace vernier {

/// A corrected command, and what is known of it.
template <int N>
struct Correction {
  JointVector<N> command;      ///< joints to send to the arm [rad, m]
  IkStatus status;             ///< converged, or why the target is not met
  double predicted_error = 0;  ///< distance from the target that the model predicts for `command` [m]
  double gate =
      1;  ///< share of the learned correction that was used: 1 inside the measured joint ranges, 0 far outside
};

/// What knows where an arm will really go, and which joints bring it where it should. No call allocates or throws.
///
/// - `predict(q)`: the pose the arm takes when commanded q
/// - `correct(q)`: the command that brings it where the nominal arm would be at q
template <class C>
concept Compensator = requires(const C& compensator, const JointVector<C::dof>& q) {
  { compensator.predict(q) }
  noexcept->std::same_as<Isometry3>;
  { compensator.correct(q) }
  noexcept->std::same_as<Correction<C::dof>>;
};

/// What a correction aims at.
enum class CorrectionTarget {
  automatic,  ///< the full pose for six joints or more, else the position
  pose,       ///< position and orientation
  position,   ///< the position alone; orientation is left to fall as it may (the paper's mode)
};

/// How commands are corrected.
struct CorrectionOptions {
  /// What a correction aims at.
  CorrectionTarget target = CorrectionTarget::automatic;
  int moving_joints = 0;             ///< number of leading joints that are corrected; 0: all (the paper moves 3)
  double position_tolerance = 1e-6;  ///< the paper's epsilon [m]
  double rotation_tolerance = 1e-6;  ///< [rad]
  int max_iterations = 30;           ///< evaluations of the model

  /// @throws std::invalid_argument naming the value
  template <int N>
  void validate() const {
    require(moving_joints >= 0 && moving_joints <= N, "CorrectionOptions: moving_joints is ", moving_joints,
            ", must lie in 0..", N);
    require(position_tolerance > 0 && rotation_tolerance > 0, "CorrectionOptions: tolerances ", position_tolerance,
            " m and ", rotation_tolerance, " rad must be positive");
    require(max_iterations >= 1, "CorrectionOptions: max_iterations is ", max_iterations, ", must be at least 1");
  }
};

}  // namespace vernier
