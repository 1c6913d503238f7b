// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The literal targets of a robot program, as they are found in its text.

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Languages of robot programs.
enum class ProgramLanguage {
  rapid,     ///< ABB
  krl,       ///< KUKA
  urscript,  ///< Universal Robots
  fanuc_tp,  ///< Fanuc, the text form of teach pendant programs
};

/// Bytes of a text from `begin` to before `end`.
struct ByteRange {
  std::size_t begin;  ///< first byte
  std::size_t end;    ///< behind the last byte
};

/// What a target states.
enum class TargetKind {
  pose,    ///< of a tool in a work object
  joints,  ///< joint values
};

/// How the arm moves to a target.
enum class TargetMove {
  unknown,  ///< no move of the text names the target, or several kinds of moves do
  joint,    ///< all joints together
  linear,   ///< along a line or an arc
};

/// A target written as numbers, of an arm of six joints.
struct ProgramTarget {
  std::size_t line = 0;                    ///< where it begins, counted from 1
  std::size_t column = 0;                  ///< likewise, in bytes
  TargetKind kind = TargetKind::pose;      ///< what it states
  TargetMove move = TargetMove::unknown;   ///< how the arm moves there
  std::string name{};                      ///< of the variable whose value it is; empty where it stands in a move
  Isometry3 pose = Isometry3::Identity();  ///< work object_T_tool [m], of a pose
  /// Joint values [rad]; of a pose those of which the program says that they are near it. Not finite where none are.
  JointVector<6> joints = JointVector<6>::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Of a pose, which of the arm's configurations is meant; empty where the text does not say. RAPID: cf1, cf4, cf6,
  /// cfx. KRL: S, T. Fanuc: 1 for F, 1 for U, 1 for T, three turn numbers.
  std::vector<int> configuration{};
  std::string tool{};        ///< name or number of the tool of a pose; empty where the text does not say
  std::string workobject{};  ///< name or number of its work object; likewise
  /// The numbers in the text: x, y, z and the rotation, or six joint values.
  std::vector<ByteRange> numbers{};
  std::vector<ByteRange> configuration_numbers{};  ///< those of the configuration that are numbers
  /// The target from which the arm comes, as the moves follow each other in the text: an index below its own.
  std::optional<std::size_t> previous{};
};

/// An input without which a target cannot be corrected.
enum class MissingInput {
  none,               ///< no input would help
  controller,         ///< the kinematics of the robot's controller
  tool,               ///< the frame of the target's tool
  workobject,         ///< the frame of the target's work object
  effect,             ///< whether a statement, or a routine of another file, changes what targets mean
  controller_joints,  ///< how the controller counts the joints of the arm, see `ControllerMap`
};

/// What is not corrected, and why.
struct Uncorrected {
  std::size_t line;                           ///< counted from 1
  std::string text;                           ///< what stands there, shortened to printable characters
  std::string reason;                         ///< why
  MissingInput missing = MissingInput::none;  ///< the input of `correct_program` or `parse_program` that it lacks
};

/// The targets of a program.
struct RobotProgram {
  ProgramLanguage language = ProgramLanguage::rapid;  ///< in which it is written
  /// In the order in which moves first use them; behind them, as they stand in the text, those that no move uses.
  std::vector<ProgramTarget> targets{};
  std::vector<Uncorrected> uncorrected{};          ///< targets that are no literals, in the order of lines
  std::map<std::string, Isometry3> tools{};        ///< flange_T_tool of the tools whose frame the text states [m]
  std::map<std::string, Isometry3> workobjects{};  ///< robot base_T_work object, likewise [m]
  std::size_t stamp_at = 0;                        ///< byte at which a comment may be inserted
  std::string end_of_line = "\n";                  ///< of the text
};

}  // namespace vernier
