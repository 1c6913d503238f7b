// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Correction of the targets of a robot program, for any controller and any calibrated arm.

#include <vector>

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/robot_programs/corrected_program.hpp"

namespace vernier::detail {

/// A controller and the calibrated arm that it moves, their types forgotten. Poses are of the last frame of the nominal
/// chain in its first one [m], joint values of the controller's six revolute joints [rad].
struct ProgramArm {
  /// Where the controller believes the arm to be.
  FunctionRef<Isometry3(const JointVector<6>& joints)> pose;
  /// The joint values to which the controller moves for a pose, see `controller_joints`.
  FunctionRef<ControllerJoints(const Isometry3& pose, const std::vector<int>& configuration,
                               const JointVector<6>& close_to)>
      joints;
  /// The command that brings the calibrated arm to a pose, near joint values, coming from a command before.
  FunctionRef<Correction<6>(const Isometry3& pose, const JointVector<6>& joints, const JointVector<6>& previous)>
      correct;
  /// The branch of joint values.
  FunctionRef<int(const JointVector<6>& joints)> branch;
  bool poses;   ///< whether the kinematics by which the controller reaches poses are known
  bool mapped;  ///< whether the arm states how the controller counts its joints
};

/// Corrects every target of a program.
/// @throws std::invalid_argument for options that do not fit the program
VERNIER_API CorrectedProgram correct_targets(const RobotProgram& program, const ProgramArm& arm,
                                             const ProgramOptions& options);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/target_correction.ipp"
#endif
