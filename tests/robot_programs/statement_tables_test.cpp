// SPDX-License-Identifier: BSD-3-Clause
// The tables of statements, and those of the guide: each name is in both, and in one class.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
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

/// Statements of a language.
struct Table {
  const char* title;
  std::string harmless, functions, moves, options;
  const char* title_of_options;
  std::span<const ProgramStatement> others;
};

std::string joined(std::initializer_list<std::string_view> lists) {
  std::string out;
  for (const std::string_view list : lists) out += std::string(list) + ' ';
  return out;
}

std::vector<Table> tables() {
  using namespace detail;
  std::string arguments;
  for (const UrscriptMove& move : urscript_move_arguments) arguments += std::string(move.arguments) + ' ';
  const char* const options = "honoured: options of moves";
  return {{"RAPID", std::string(rapid_harmless), std::string(rapid_functions),
           joined({rapid_joint_moves, rapid_linear_moves, rapid_circular_moves}), std::string(rapid_move_options),
           options, rapid_statements},
          {"KRL", joined({krl_harmless, krl_functions, krl_words, krl_words_alone}), "", "", "", "", krl_statements},
          {"URScript", std::string(urscript_harmless), "", joined({urscript_joint_moves, urscript_linear_moves}),
           arguments, "honoured: arguments of moves", urscript_statements},
          {"Fanuc", std::string(fanuc_harmless), "", "", std::string(fanuc_move_options), options, fanuc_statements}};
}

/// The page's lists of a language: their words by the title in front, **voiding: positions**.
std::map<std::string, Words> page_lists(const std::string& title) {
  std::ifstream file(VERNIER_STATEMENTS_PAGE);
  std::string line, kind;
  bool inside = false, listed = false;
  std::map<std::string, Words> out;
  while (std::getline(file, line)) {
    if (line.starts_with("## ")) inside = line == "## " + title;
    if (line.starts_with("**")) kind = line.substr(2, line.rfind("**") - 2);
    if (line.starts_with("```")) listed = !listed;
    if (!inside || !listed || line.starts_with("```")) continue;
    const bool ends = line.starts_with("until ");
    if (ends) line.erase(0, 6);
    for (std::size_t begin = 0; begin < line.size();) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      const std::string word = detail::lower_case(line.substr(begin, end - begin));
      // a statement that ends what it begins stands in both lines
      EXPECT_TRUE(out[kind].insert(word).second || ends || kind.starts_with("honoured")) << word << " is there twice";
      begin = line.find_first_not_of(", ", end);
    }
  }
  return out;
}

/// What the page calls a state.
std::string called(detail::ProgramState state) {
  using enum detail::ProgramState;
  switch (state) {
    case joint_moves: return "configurations in joint moves";
    case linear_moves: return "configurations in linear moves";
    case displacement: return "positions";
    case orientation: return "orientations of linear moves";
    case external_axes: return "external axes";
    case external_tool: return "the tool stands still";
    case tracking: return "work objects that move";
    case frame_data: return "frames of tools and work objects";
    case following: return "where the arm gives way";
    default: return "all targets";
  }
}

/// The page's title of a row's list.
std::string list_of(const ProgramStatement& row) {
  switch (row.kind) {
    case StatementClass::harmless: return "harmless";
    case StatementClass::moves: return "moves without a target, listed";
    case StatementClass::own: return "voiding: targets in their own arguments";
    default: return "voiding: " + called(row.state);
  }
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
    std::map<std::string, Words> lists{{"harmless", detail::words_of(table.harmless)}};
    if (!table.functions.empty()) lists["harmless functions"] = detail::words_of(table.functions);
    if (!table.moves.empty()) lists["honoured: moves"] = detail::words_of(table.moves);
    if (!table.options.empty()) lists[table.title_of_options] = detail::words_of(table.options);
    for (const ProgramStatement& row : table.others) lists[list_of(row)].insert(shown(table.title, row));
    EXPECT_EQ(page_lists(table.title), lists) << table.title;
  }
}

TEST(StatementTables, HaveEachNameInOneClass) {
  for (const Table& table : tables()) {
    const Words harmless = detail::words_of(table.harmless + ' ' + table.functions);
    std::set<std::pair<std::string_view, std::string_view>> seen;
    for (const ProgramStatement& row : table.others) {
      EXPECT_TRUE(seen.insert({row.name, row.option}).second) << row.name;
      EXPECT_EQ(harmless.count(row.name), 0u) << row.name;
      EXPECT_EQ(std::string(row.name), detail::lower_case(row.name));
      EXPECT_FALSE(detail::reason_of(row.state).empty());
    }
    for (const std::string& name : detail::words_of(table.moves)) EXPECT_EQ(harmless.count(name), 0u) << name;
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
