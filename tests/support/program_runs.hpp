// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Programs of examples/ run one after the other in a folder of their own.

#include <gtest/gtest.h>

#include <string>

#include "run_command.hpp"
#include "temporary_folder.hpp"

namespace vernier_test {

class ProgramRuns {
 public:
  explicit ProgramRuns(const std::string& name) : folder_(name) {}

  /// @param command name of a program, a quotation mark, its arguments
  CommandResult run(const std::string& command) const {
    return run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + command,
                       folder_.path());
  }
  /// What the program prints; it must succeed.
  std::string done(const std::string& command) const {
    const CommandResult result = run(command);
    EXPECT_EQ(result.exit_code, 0) << command << ": " << result.errors;
    return result.output;
  }

 protected:
  TemporaryFolder folder_;
};

}  // namespace vernier_test
