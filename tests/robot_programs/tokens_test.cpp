// SPDX-License-Identifier: BSD-3-Clause
// Words, numbers and texts of robot programs, and values in brackets: where each begins and ends.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "read_program.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/robot_programs/detail/program_text.hpp"

namespace vernier::robot_tokens_test {
namespace {

using namespace vernier_test;
using detail::ProgramText;
using Kind = detail::ProgramToken::Kind;

ProgramText read(std::string_view text) { return ProgramText::of(text, "f", {.comments = "!;", .quotes = "\"'"}); }

/// Tokens with a letter for their kind: w(ord), n(umber), t(ext), s(ign), e(nd of a line).
std::string tokens_of(const std::string& text) {
  const ProgramText read_text = read(text);
  std::string out;
  for (std::size_t i = 0; i < read_text.tokens.size(); ++i) {
    out += "wntse"[static_cast<int>(read_text.tokens[i].kind)];
    if (!read_text.is_line_end(i)) out += std::string(read_text.at(i));
    out += '|';
  }
  return out;
}

TEST(TokensWhiteBox, OfEachKind) {
  EXPECT_EQ(tokens_of(""), "e|");
  EXPECT_EQ(tokens_of("\xEF\xBB\xBFMoveL p10"), "wMoveL|wp10|e|");
  EXPECT_EQ(tokens_of("a1 $b _c \xE4z 1a"), "wa1|w$b|w_c|w\xE4z|n1|wa|e|");
  EXPECT_EQ(tokens_of("a\tb\rc\fd\ve f"), "wa|wb|e|wc|wd|we|wf|e|");
  EXPECT_EQ(tokens_of("a@b`c[d{e/f:g"), "wa|s@|wb|s`|wc|s[|wd|s{|we|s/|wf|s:|wg|e|");
  EXPECT_EQ(tokens_of("a ! b \" c\nd ; e"), "wa|e|wd|e|");
}

TEST(TokensWhiteBox, Numbers) {
  EXPECT_EQ(tokens_of("5 .5 5. 5.25"), "n5|n.5|n5.|n5.25|e|");
  EXPECT_EQ(tokens_of(". .a"), "s.|s.|wa|e|");
  EXPECT_EQ(tokens_of("."), "s.|e|");
  EXPECT_EQ(tokens_of("1.2.3"), "n1.2|n.3|e|");
  EXPECT_EQ(tokens_of("1e5 1E5 1e+5 1.5e-05"), "n1e5|n1E5|n1e+5|n1.5e-05|e|");
  EXPECT_EQ(tokens_of("1e 1e+ 1e+x"), "n1|we|n1|we|s+|n1|we|s+|wx|e|");
  for (const char* end : {"1", "1.", "1e5", "1e+5"}) EXPECT_EQ(tokens_of(end), "n" + std::string(end) + "|e|");
  EXPECT_EQ(tokens_of("1e"), "n1|we|e|");
  EXPECT_EQ(read("2.5E-1").tokens[0].value, 0.25);
  EXPECT_EQ(read(".5").tokens[0].value, 0.5);
  EXPECT_TRUE(std::isnan(read("1e999").tokens[0].value));
}

TEST(TokensWhiteBox, Texts) {
  EXPECT_EQ(tokens_of("\"a'b\" 'c\"d' e"), "t\"a'b\"|t'c\"d'|we|e|");
  EXPECT_EQ(tokens_of("\"\" x"), "t\"\"|wx|e|");
  EXPECT_EQ(tokens_of("'open\nx"), "t'open|e|wx|e|");  // at the end of its line at the latest
  EXPECT_EQ(tokens_of("'open"), "t'open|e|");
  EXPECT_EQ(tokens_of("'"), "t'|e|");
}

TEST(TokensWhiteBox, LinesAreCounted) {
  const ProgramText text = read("a\n\n'b\nc");
  std::vector<std::size_t> lines;
  for (const detail::ProgramToken& token : text.tokens) lines.push_back(token.line);
  EXPECT_EQ(lines, (std::vector<std::size_t>{1, 1, 2, 3, 3, 4, 4}));
}

TEST(TokensWhiteBox, BracketsHavePartners) {
  const ProgramText text = read("(a[b]{c}) ) [");
  const auto partner = [&](std::size_t i) { return text.tokens[i].partner; };
  EXPECT_EQ(partner(0), 8u);
  EXPECT_EQ(partner(2), 4u);
  EXPECT_EQ(partner(5), 7u);
  EXPECT_EQ(partner(10), 0u);  // nothing closes it
  EXPECT_EQ(detail::behind_brackets(text, 0, 20), 9u);
  EXPECT_EQ(detail::behind_brackets(text, 0, 5), 5u);
  EXPECT_EQ(detail::behind_brackets(text, 10, 20), 20u);
  EXPECT_EQ(detail::behind_brackets(text, 1, 20), 1u);  // no bracket
  // the first bracket of a text
  EXPECT_EQ(detail::behind_brackets(read("[1]"), 0, 9), 3u);
}

TEST(TokensWhiteBox, LimitsOfTextsAndLines) {
  const auto refused = [](const std::string& text) -> std::string {
    try {
      (void)read(text);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  const std::string longest(100'000, 'a');
  EXPECT_EQ(refused(longest + "\n" + longest), "");
  EXPECT_EQ(refused("\n" + longest + "a\n"), "f, line 2: 100001 bytes in a line, at most 100000");
  EXPECT_EQ(refused("\n" + longest + "a"), "f, line 2: 100001 bytes in a line, at most 100000");
  std::string most(16u << 20u, ' ');
  for (std::size_t i = 0; i < most.size(); i += 1000) most[i] = '\n';
  EXPECT_EQ(refused(most), "");
  EXPECT_EQ(refused(most + ' '), "f: 16777217 bytes, at most 16777216");
  for (const std::string zero : {"a", "!", "'"})
    EXPECT_EQ(refused("\n" + zero + std::string(1, '\0')), "f, line 2: binary data, not text") << zero;
}

TEST(TokensWhiteBox, ExcerptsOfWhatIsPrintable) {
  EXPECT_EQ(detail::excerpt("  a \t\r\n b  "), "a b");
  EXPECT_EQ(detail::excerpt("a~!\x7F\x1F\xE4"), "a~!???");
  const std::string sixty(60, 'x');
  EXPECT_EQ(detail::excerpt(sixty), sixty);
  EXPECT_EQ(detail::excerpt(sixty + 'x'), sixty + "...");
  const ProgramText text = read("a [b] c");
  EXPECT_EQ(detail::excerpt(text, 1, 4), "[b]");
  EXPECT_EQ(detail::excerpt(text, 2, 2), "");
}

TEST(TokensWhiteBox, SignedNumbers) {
  const ProgramText text = read("-2.5 +3 4 -x 1e999");
  std::size_t next = 0;
  ByteRange range{0, 0};
  EXPECT_EQ(detail::signed_number(text, 0, next, range), -2.5);
  EXPECT_EQ(next, 2u);
  EXPECT_EQ(range.begin, 0u);
  EXPECT_EQ(range.end, 4u);
  EXPECT_EQ(detail::signed_number(text, 2, next, range), 3);
  EXPECT_EQ(range.begin, 5u);  // with its sign
  EXPECT_EQ(detail::signed_number(text, 4, next, range), 4);
  for (const std::size_t none : {5u, 7u, 8u, 99u}) EXPECT_FALSE(detail::signed_number(text, none, next, range)) << none;
}

/// What is read from the bracket with which a text begins; a word for what is no number.
std::string value_of(const detail::BracketValue& value, const std::string& text) {
  if (!value.group)
    return (value.number ? "#" : "") + text.substr(value.range.begin, value.range.end - value.range.begin);
  std::string out = "[";
  for (const detail::BracketValue& one : value.values) out += value_of(one, text) + ",";
  return out + "]";
}
std::string value_of(const std::string& text) {
  const ProgramText tokens = read(text);
  std::size_t i = 0;
  const detail::BracketValue value = detail::read_brackets(tokens, i, '\0');
  return value_of(value, text) + text.substr(value.range.end);
}

TEST(TokensWhiteBox, ValuesInBrackets) {
  EXPECT_EQ(value_of("[1,-2,x]"), "[#1,#-2,x,]");
  EXPECT_EQ(value_of("[]"), "[]");
  EXPECT_EQ(value_of("[[1],[],[a,[+2.5]]] rest"), "[[#1,],[],[a,[#+2.5,],],] rest");
  EXPECT_EQ(value_of("[1\n,\n2\n]"), "[#1,#2,]");
  EXPECT_EQ(value_of("[1+2,a*b]"), "[1+2,a*b,]");             // an expression is no number
  EXPECT_EQ(value_of("[f(1,[2,3]),4]"), "[f(1,[2,3]),#4,]");  // nor is a call, whose commas are its own
  EXPECT_EQ(value_of("[(1),{2},-x]"), "[(1),{2},-x,]");
  const ProgramText text = read("a\n[1,\n[2]]");
  std::size_t i = 2;
  const detail::BracketValue value = detail::read_brackets(text, i, '\0');
  EXPECT_EQ(value.line, 2u);
  EXPECT_EQ(value.token, 2u);
  EXPECT_EQ(value.values[1].line, 3u);
  EXPECT_EQ(i, 10u);
  EXPECT_TRUE(value.values[1].numbers(1));
  EXPECT_FALSE(value.values[1].numbers(2));
  EXPECT_FALSE(value.numbers(2));  // one is a group
}

TEST(TokensWhiteBox, BracketsThatStayOpen) {
  const auto refused = [](const std::string& text, char terminator) -> std::string {
    try {
      const ProgramText tokens = read(text);
      std::size_t i = 0;
      (void)detail::read_brackets(tokens, i, terminator);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused("[1,\n2", '\0'), "f, line 1: a bracket [ is not closed");
  EXPECT_EQ(refused("[1,%2]", '%'), "f, line 1: a bracket [ is not closed");
  EXPECT_EQ(refused("[a%2]", '%'), "f, line 1: a bracket [ is not closed");
  EXPECT_EQ(refused("[a%2]", '\0'), "");
  EXPECT_EQ(refused(std::string(32, '[') + std::string(32, ']'), '\0'), "");
  EXPECT_EQ(refused(std::string(33, '[') + std::string(33, ']'), '\0'), "f, line 1: brackets nested deeper than 32");
}

TEST(TokensWhiteBox, RemarksInTheOrderOfLines) {
  RobotProgram program;
  program.uncorrected = {{3, "a", "x"}, {1, "b", "x"}, {3, "c", "x"}, {1, "d", "x"}, {2, "e", "x"}};
  detail::use_targets(read("a\r\n"), {}, {}, program);
  EXPECT_EQ(remarks(program), "1 b: x\n1 d: x\n2 e: x\n3 a: x\n3 c: x\n");
  EXPECT_EQ(program.end_of_line, "\r\n");
}

TEST(TokensWhiteBox, AMillionUsesOfTargetsAtMost) {
  RobotProgram program;
  std::vector<detail::ProgramStep> steps(detail::most_steps);
  detail::use_targets(read("a"), steps, {}, program);
  steps.emplace_back();
  EXPECT_THROW(detail::use_targets(read("a"), steps, {}, program), DataError);
}

}  // namespace
}  // namespace vernier::robot_tokens_test
