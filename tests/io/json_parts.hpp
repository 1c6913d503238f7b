// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// JSON that has some parts.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace vernier_test {

/// Objects have the members that are wanted, lists the entries and no more; numbers are equal to 1e-12.
/// @param at where the value stands, for messages
inline void expect_parts(const nlohmann::ordered_json& found, const nlohmann::ordered_json& wanted,
                         const std::string& at = "") {
  if (wanted.is_object()) {
    for (const auto& [key, value] : wanted.items()) {
      ASSERT_TRUE(found.contains(key)) << at << '/' << key;
      expect_parts(found.at(key), value, at + '/' + key);
    }
  } else if (wanted.is_array()) {
    ASSERT_EQ(found.size(), wanted.size()) << at;
    for (std::size_t k = 0; k < wanted.size(); ++k)
      expect_parts(found.at(k), wanted.at(k), at + '/' + std::to_string(k));
  } else if (wanted.is_number()) {
    ASSERT_TRUE(found.is_number()) << at;
    EXPECT_NEAR(found.get<double>(), wanted.get<double>(), 1e-12) << at;
  } else {
    EXPECT_EQ(found, wanted) << at;
  }
}

/// @param wanted JSON
inline void expect_parts(const nlohmann::ordered_json& found, const char* wanted) {
  expect_parts(found, nlohmann::ordered_json::parse(wanted));
}

}  // namespace vernier_test
