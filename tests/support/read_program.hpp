// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a test asks of a robot program that was read.

#include <stdexcept>
#include <string>

#include "vernier/core/check.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier_test {

/// What is not corrected, a line each: number, text, reason.
inline std::string remarks(const vernier::RobotProgram& program) {
  std::string out;
  for (const vernier::Uncorrected& one : program.uncorrected)
    out += vernier::message(one.line, ' ', one.text, ": ", one.reason, "\n");
  return out;
}

/// The target of that name.
inline const vernier::ProgramTarget& named(const vernier::RobotProgram& program, const std::string& name) {
  for (const vernier::ProgramTarget& target : program.targets)
    if (target.name == name) return target;
  throw std::runtime_error("no target " + name + "; remarks: " + remarks(program));
}

/// The name of the target from which the arm comes; empty where nobody knows.
inline std::string before(const vernier::RobotProgram& program, const std::string& name) {
  const auto& previous = named(program, name).previous;
  return previous ? program.targets[*previous].name : "";
}

}  // namespace vernier_test
