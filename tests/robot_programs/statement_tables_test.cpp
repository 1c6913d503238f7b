// SPDX-License-Identifier: BSD-3-Clause
// The tables of statements, and those of the guide: each name is in both, and in one class.

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "vernier/core/check.hpp"
#include "vernier/robot_programs/detail/fanuc_tp_statements.hpp"
#include "vernier/robot_programs/detail/krl_statements.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"
#include "vernier/robot_programs/detail/rapid_statements.hpp"
#include "vernier/robot_programs/detail/urscript_statements.hpp"

namespace vernier::robot_statement_tables_test {
namespace {

using detail::ProgramStatement;
using detail::StatementClass;
using Words = std::set<std::string, std::less<>>;

/// Statements of a language, the names of all moves and options joined.
struct Table {
  const char* title;
  std::string harmless, honoured;
  std::span<const ProgramStatement> others;
};

std::string joined(std::initializer_list<std::string_view> lists) {
  std::string out;
  for (const std::string_view list : lists) out += std::string(list) + ' ';
  return out;
}

std::vector<Table> tables() {
  using namespace detail;
  return {{"RAPID", joined({rapid_harmless, rapid_functions}),
           joined({rapid_joint_moves, rapid_linear_moves, rapid_circular_moves, rapid_move_options}), rapid_statements},
          {"KRL", joined({krl_harmless, krl_functions, krl_words, krl_words_alone}), "", krl_statements},
          {"URScript", std::string(urscript_harmless), joined({urscript_joint_moves, urscript_linear_moves}),
           urscript_statements},
          {"Fanuc", std::string(fanuc_harmless), std::string(fanuc_move_options), fanuc_statements}};
}

/// What stands between ` in the rows of one class of the page's table of a language.
Words page_words(const std::string& title, const std::string& kind) {
  std::ifstream file(VERNIER_STATEMENTS_PAGE);
  std::string line;
  bool inside = false;
  Words out;
  while (std::getline(file, line)) {
    if (line.starts_with("## ")) inside = line == "## " + title;
    if (!inside || line.find(kind) == std::string::npos || line.find(kind) > 30) continue;
    for (std::size_t open = line.find('`'); open != std::string::npos;) {
      const std::size_t close = line.find('`', open + 1);
      out.insert(detail::lower_case(line.substr(open + 1, close - open - 1)));
      open = line.find('`', close + 1);
    }
  }
  return out;
}

/// A row as the page names it.
std::string shown(const std::string& title, const ProgramStatement& row) {
  if (row.option.empty() || row.option == "*") return std::string(row.name);
  if (title == "RAPID") return message(row.name, " \\", row.option);
  if (title == "KRL")
    return row.name[0] == '$' ? message(row.name, "=", row.option) : message(row.name, "(", row.option, ")");
  return message(row.name, " ", row.option);
}

TEST(StatementTables, AreThoseOfThePage) {
  for (const Table& table : tables()) {
    Words harmless = detail::words_of(table.harmless), voiding, moves;
    for (const ProgramStatement& row : table.others) {
      if (row.kind == StatementClass::harmless)
        harmless.insert(shown(table.title, row));
      else
        (row.kind == StatementClass::moves ? moves : voiding).insert(shown(table.title, row));
    }
    EXPECT_EQ(page_words(table.title, "harmless"), harmless) << table.title;
    EXPECT_EQ(page_words(table.title, "voiding"), voiding) << table.title;
    EXPECT_EQ(page_words(table.title, "moves without a target"), moves) << table.title;
    const Words honoured = page_words(table.title, "honoured");
    for (const std::string& name : detail::words_of(table.honoured)) EXPECT_EQ(honoured.count(name), 1u) << name;
  }
}

TEST(StatementTables, HaveEachNameInOneClass) {
  for (const Table& table : tables()) {
    const Words harmless = detail::words_of(table.harmless), honoured = detail::words_of(table.honoured);
    std::set<std::pair<std::string_view, std::string_view>> seen;
    for (const ProgramStatement& row : table.others) {
      EXPECT_TRUE(seen.insert({row.name, row.option}).second) << row.name;
      EXPECT_EQ(harmless.count(row.name), 0u) << row.name;
      EXPECT_EQ(std::string(row.name), detail::lower_case(row.name));
      EXPECT_FALSE(detail::reason_of(row.state).empty());
    }
    if (std::string(table.title) == "Fanuc") continue;  // its options are no statements
    for (const std::string& name : honoured) EXPECT_EQ(harmless.count(name), 0u) << name;
  }
}

TEST(StatementTables, FindRowsByNameAndOption) {
  const detail::StatementTable table("a b", detail::rapid_statements, {"PDispSet", "C"});
  const auto kind = [&](const char* name, const char* option) { return table.find(name, option).kind; };
  EXPECT_EQ(kind("a", ""), StatementClass::harmless);
  EXPECT_EQ(kind("b", "x"), StatementClass::harmless);
  EXPECT_EQ(kind("c", ""), StatementClass::harmless);
  EXPECT_EQ(kind("pdispset", " "), StatementClass::harmless);
  EXPECT_EQ(kind("confj", "off"), StatementClass::voids);
  EXPECT_EQ(kind("confj", "on"), StatementClass::ends);
  EXPECT_EQ(kind("confj", "x"), StatementClass::unknown);
  EXPECT_EQ(kind("singarea", "wrist"), StatementClass::voids);
  EXPECT_EQ(kind("singarea", "off"), StatementClass::ends);
  EXPECT_EQ(kind("nobody", ""), StatementClass::unknown);
}

}  // namespace
}  // namespace vernier::robot_statement_tables_test
