// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/statement_tables.hpp"

namespace vernier::detail {

VERNIER_IMPL std::set<std::string, std::less<>> words_of(std::string_view text) {
  std::set<std::string, std::less<>> out;
  while (!text.empty()) {
    const std::size_t end = (std::min)(text.find(' '), text.size());
    if (end > 0) out.insert(std::string(text.substr(0, end)));
    text.remove_prefix((std::min)(end + 1, text.size()));
  }
  return out;
}

VERNIER_IMPL StatementTable::StatementTable(std::string_view harmless, std::span<const ProgramStatement> others,
                                            const std::vector<std::string>& assumed)
    : harmless_(words_of(harmless)) {
  for (const ProgramStatement& row : others) others_.emplace(row.name, row);
  for (const std::string& name : assumed) {
    others_.erase(lower_case(name));
    harmless_.insert(lower_case(name));
  }
}

VERNIER_IMPL ProgramStatement StatementTable::find(const std::string& name, const std::string& option) const {
  if (harmless_.count(name) != 0) return {{}, {}, StatementClass::harmless};
  ProgramStatement out{{}, {}, StatementClass::unknown};
  const auto [first, last] = others_.equal_range(name);
  for (auto row = first; row != last; ++row)
    if (row->second.option == option || (row->second.option == "*" && out.kind == StatementClass::unknown))
      out = row->second;
  return out;
}

}  // namespace vernier::detail
