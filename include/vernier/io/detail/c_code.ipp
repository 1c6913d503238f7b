// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <vector>

#include "vernier/io/detail/c_code.hpp"

namespace vernier::detail {

VERNIER_IMPL std::string c_capitals(std::string name) {
  for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return name;
}

VERNIER_IMPL std::string with_name(std::string_view text, const std::string& name) {
  const std::string capitals = c_capitals(name);
  std::string out;
  bool within = false;  // an identifier
  while (!text.empty()) {
    const bool lower_case = !within && text.starts_with("arm_"), upper_case = !within && text.starts_with("ARM_");
    if (lower_case || upper_case) {
      out += lower_case ? name : capitals;
      text.remove_prefix(3);
    }
    const char c = text.front();
    within = c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0;
    out += c;
    text.remove_prefix(1);
  }
  return out;
}

VERNIER_IMPL std::string fill_in(std::string_view text, const std::string& name,
                                 const std::set<std::string>& features) {
  constexpr std::string_view present = "#if HAS_", absent = "#if !HAS_";
  std::string out;
  std::vector<bool> kept{true};  // of the conditions around a line
  while (!text.empty()) {
    const std::size_t end = (std::min)(text.find('\n') + 1, text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    const bool negated = line.starts_with(absent);
    if (negated || line.starts_with(present)) {
      const std::size_t begin = (negated ? absent : present).size();
      const std::string feature(line.substr(begin, line.size() - begin - 1));
      kept.push_back(kept.back() && features.contains(feature) != negated);
    } else if (line == "#else\n") {
      kept.back() = kept[kept.size() - 2] && !kept.back();
    } else if (line == "#endif\n") {
      kept.pop_back();
    } else if (kept.back()) {
      out += with_name(line, name);
    }
  }
  return out == "\n" ? "" : out;
}

}  // namespace vernier::detail
