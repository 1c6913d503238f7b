// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Parts of a page.

#include <string>

namespace vernier_test {

/// What stands between two parts, at first; empty where the first is not there.
inline std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t a = text.find(from);
  if (a == std::string::npos) return "";
  const std::size_t begin = a + from.size(), end = text.find(to, begin);
  return text.substr(begin, end == std::string::npos ? end : end - begin);
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace vernier_test
