// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Law suites return sentences; this hands them to GoogleTest.

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vernier_test {

/// `EXPECT_TRUE(no_violations(vernier::testing::kinematic_model_violations(model, samples)))`
inline ::testing::AssertionResult no_violations(const std::vector<std::string>& violations) {
  if (violations.empty()) return ::testing::AssertionSuccess();
  ::testing::AssertionResult failure = ::testing::AssertionFailure();
  for (const std::string& violation : violations) failure << "\n  " << violation;
  return failure;
}

/// Whether some sentence contains a text.
inline bool mentions(const std::vector<std::string>& violations, const std::string& text) {
  for (const std::string& violation : violations)
    if (violation.find(text) != std::string::npos) return true;
  return false;
}

}  // namespace vernier_test
