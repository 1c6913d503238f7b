// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// How a robot program is corrected, and the outcome: options of `correct_program` and the targets that it corrects.

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vernier/robot_programs/configuration.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier {

/// Frames of tools, or of work objects, by their names in a program.
struct ProgramFrames {
  /// By name or number, "gun" or "3"; upper and lower case are the same.
  std::map<std::string, Isometry3> by_name{};
  /// Of every other name, and of targets that name none; empty: these frames are unknown.
  std::optional<Isometry3> others{};
};

/// Options of `correct_program`.
struct ProgramOptions {
  ProgramFrames tools{};        ///< flange_T_tool [m]; beside those that the program states, which these replace
  ProgramFrames workobjects{};  ///< robot base_T_work object [m]; beside those that the program states, likewise
  Isometry3 robot_base = Isometry3::Identity();  ///< the controller's base in the first frame of the nominal chain [m]
  Isometry3 flange = Isometry3::Identity();      ///< the controller's flange in the last frame of the nominal chain [m]
  /// The arm as far as a language leaves it open; a Fanuc program with poses needs it.
  std::optional<ControllerArm> arm{};
  /// Joint values before the first target [rad]; not finite where unknown. They matter where it has no configuration.
  JointVector<6> start = JointVector<6>::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Whether each command is for the approach from the target before it in the text; else all commands are for the
  /// middle of both directions of approach.
  bool approach = true;
};

/// A target that was corrected.
struct CorrectedTarget {
  ReplacedTarget replaced;  ///< its new values
  double correction;        ///< distance by which the controller's flange is moved [m]
  double predicted_error;   ///< distance from the meant pose that the model predicts for the new values [m]
  double gate;        ///< share of the learned correction that was used: below 1 outside the measured joint ranges
  bool reconfigured;  ///< whether a joint passed the end of a quadrant or turn, so that its configuration changes
};

/// The targets of a program after their correction.
struct CorrectedProgram {
  std::vector<CorrectedTarget> targets{};  ///< those that are corrected, in the order of the program's targets
  /// Everything that stays as it is, in the order of lines: what the parser found, and refused targets.
  std::vector<Uncorrected> uncorrected{};

  /// The new values of all corrected targets, for `replace_targets`.
  VERNIER_API std::vector<ReplacedTarget> replaced() const;
  /// The corrected joint values of the controller, a row each [rad]. `CalibratedRobot::radii_95` takes those of the
  /// chain.
  VERNIER_API JointRows<6> commands() const;
  /// Mean distance by which a target is moved [m]; 0 where none is.
  VERNIER_API double mean_correction() const;
  /// Largest distance by which a target is moved [m].
  VERNIER_API double largest_correction() const;
  /// Largest distance from the meant pose that the model predicts [m].
  VERNIER_API double largest_predicted_error() const;
  /// Number of corrected targets outside the measured joint ranges, where the gate is below 1.
  VERNIER_API std::size_t extrapolated() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/corrected_program.ipp"
#endif
