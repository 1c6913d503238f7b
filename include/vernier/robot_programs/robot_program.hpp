// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Robot programs: their literal targets found, and replaced in place with every other byte kept.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/robot_programs/program_target.hpp"

namespace vernier {

/// The language of a program, by the ending of its name: .mod, .modx, .prg, .sys (RAPID), .src, .dat (KRL), .script
/// (URScript), .ls (Fanuc).
/// @throws DataError for another one, a binary .tp included
VERNIER_API ProgramLanguage program_language(const std::string& path);

/// Finds the literal targets of a program.
///
/// - RAPID: `robtarget` and `jointtarget`, declared or in a move, with the frames of literal `tooldata` and `wobjdata`
/// - KRL: `E6POS`, `POS`, `E6AXIS`, `AXIS`, declared or in a move, with `FDAT`, `$TOOL`, `$BASE`, `TOOL_DATA`,
/// `BASE_DATA`
/// - URScript: `p[..]` and lists of six joints in a move, or in a variable that a move uses, with `set_tcp`
/// - Fanuc: the positions `P[n]` of group 1
///
/// What moves use beside them, what the program changes and what has external axes is in `uncorrected`, and so are
/// targets behind a statement that can change what they mean, or of which nobody knows what it does. The guide lists
/// the statements. Conditions, loops, jumps and calls within the text are followed.
/// @param language of the text
/// @param text     at most 16 MiB, in any encoding that extends ASCII; lines of at most 100,000 bytes, brackets nested
///                 at most 32 deep
/// @param name     of the file, for messages
/// @param assumed_harmless names of statements, and of routines of other files, that change no target's meaning
/// @throws DataError naming file and line for what is no program, and for one that was corrected before
/// @complexity O(n log n) in the length of the text
VERNIER_API RobotProgram parse_program(ProgramLanguage language, std::string_view text, const std::string& name,
                                       const std::vector<std::string>& assumed_harmless = {});

/// New values of a target.
struct ReplacedTarget {
  std::size_t target;     ///< its index
  Isometry3 pose;         ///< work object_T_tool, of a pose [m]
  JointVector<6> joints;  ///< where the controller is to stand: joints to write, or those of the pose [rad]
};

/// The text with new numbers for some targets, every other byte as it was. Lengths have 4 decimals in mm (7 in m),
/// angles 6 in degrees (8 in rad), quaternions 9. Of the configuration, numbers that the joint values contradict are
/// replaced: quadrants, the bits of KRL's T, the last turn number of Fanuc.
/// @throws std::invalid_argument for a target that the program does not have, and values that are not finite
VERNIER_API std::string replace_targets(std::string_view text, const RobotProgram& program,
                                        std::span<const ReplacedTarget> replaced);

/// The text with a comment by which `parse_program` knows that it was corrected, and refuses it.
/// @param text    as parsed, or with replaced targets
/// @param program what was parsed
/// @param lines   of the comment; characters other than printable ASCII become `?`, long lines are broken
VERNIER_API std::string stamped(std::string_view text, const RobotProgram& program,
                                const std::vector<std::string>& lines);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/robot_program.ipp"
#endif
