// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "vernier/core/atomic_file.hpp"

namespace vernier_test {

/// What a command did.
struct CommandResult {
  int exit_code;  ///< -1 when a signal ended it
  std::string output, errors;

  /// Whether it complained in exactly one line.
  bool one_line_of_errors() const {
    return !errors.empty() && errors.back() == '\n' && std::count(errors.begin(), errors.end(), '\n') == 1;
  }
};

/// Runs a shell command and keeps what it said.
/// @param folder where its two streams are kept meanwhile
inline CommandResult run_command(const std::string& command, const std::filesystem::path& folder) {
  const auto output = folder / "stdout.txt", errors = folder / "stderr.txt";
  const int status =
      std::system(("{ " + command + "; } >'" + output.string() + "' 2>'" + errors.string() + "' </dev/null").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, vernier::read_file(output), vernier::read_file(errors)};
}

}  // namespace vernier_test
