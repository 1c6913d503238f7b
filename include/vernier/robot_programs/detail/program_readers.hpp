// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The readers of robot programs, one a language.

#include <string>
#include <string_view>
#include <vector>

#include "vernier/core/api.hpp"
#include "vernier/robot_programs/program_target.hpp"

namespace vernier::detail {

/// The readers of the languages.
/// @param assumed names of statements that are harmless whatever the tables say
VERNIER_API void read_rapid(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                            RobotProgram& program);
VERNIER_API void read_krl(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                          RobotProgram& program);
VERNIER_API void read_urscript(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                               RobotProgram& program);
VERNIER_API void read_fanuc_tp(std::string_view text, const std::string& name, const std::vector<std::string>& assumed,
                               RobotProgram& program);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/robot_programs/detail/fanuc_tp.ipp"
#include "vernier/robot_programs/detail/krl.ipp"
#include "vernier/robot_programs/detail/rapid.ipp"
#include "vernier/robot_programs/detail/urscript.ipp"
#endif
