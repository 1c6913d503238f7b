// SPDX-License-Identifier: BSD-3-Clause
// Damaged programs: whatever the bytes, the answer is a program or a message in one line.

#include <gtest/gtest.h>

#include "robot_program_samples.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_damage_test {
namespace {

using namespace vernier_test;

/// Some bytes overwritten, cut, repeated or replaced by pieces that programs are made of.
std::string damaged(std::string text, Rng& rng) {
  static const std::vector<std::string> pieces{"[",          "]",     "{",        "}",      "(",  ")",       ";",
                                               ",",          ":=",    "\n",       "\"",     "'",  "9E9",     "1e400",
                                               "-",          "E6POS", "DECL",     "MoveL ", "p[", "P[1]",    "GP1:",
                                               "CONFIG : '", "\xFF",  "set_tcp(", "=",      "X ", "\\WObj:="};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(rng.uniform() * static_cast<double>(n)); };
  for (std::size_t change = 1 + below(6); change > 0 && !text.empty(); --change) {
    const std::size_t at = below(text.size());
    switch (below(4)) {
      case 0: text[at] = static_cast<char>(1 + below(255)); break;
      case 1: text.erase(at, 1 + below(40)); break;
      case 2: text.insert(at, pieces[below(pieces.size())]); break;
      default: text.insert(at, text.substr(below(text.size()), 1 + below(80)));
    }
  }
  return text;
}

TEST(DamagedPrograms, AreReadOrRefused) {
  Rng rng(11);
  int read = 0, refused = 0;
  for (int round = 0; round < 4000; ++round) {
    const ProgramSample sample = std::vector<ProgramSample>{rapid_sample(), krl_sample(), krl_source_sample(),
                                                            urscript_sample(), fanuc_sample()}[round % 5u];
    const std::string text = damaged(sample.text, rng);
    try {
      const RobotProgram program = parse_program(sample.language, text, "f");
      ASSERT_EQ(replace_targets(text, program, {}), text);
      std::vector<ReplacedTarget> same;
      for (std::size_t k = 0; k < program.targets.size(); ++k) {
        const ProgramTarget& target = program.targets[k];
        ASSERT_TRUE(!target.previous || *target.previous < k);
        const bool pose = target.kind == TargetKind::pose;
        if ((!pose && !(target.joints.array().abs() < 1e6).all()) || (pose && target.pose.translation().norm() > 1e6))
          continue;
        same.push_back({k, target.pose, pose ? JointVector<6>(JointVector<6>::Zero()) : target.joints});
      }
      const std::string written = replace_targets(text, program, same);
      EXPECT_EQ(parse_program(sample.language, written, "f").targets.size(), program.targets.size()) << text;
      EXPECT_THROW((void)parse_program(sample.language, stamped(written, program, {"x"}), "f"), DataError);
      ++read;
    } catch (const DataError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 300);
}

TEST(DamagedPrograms, ManyBracketsTakeNoLongTime) {
  using enum ProgramLanguage;
  const auto many = [](const std::string& piece) {
    std::string out;
    while (out.size() < 20000) out += piece;
    return out;
  };
  for (const char* piece : {"[", "{", "(", "a{", "a:=", "a=", "movej(", "MoveL ", "p[", "PTP {", "P[1]{"})
    for (const auto& [language, head] : {std::pair(rapid, "MODULE m\n"), std::pair(krl, "DEF m()\n"),
                                         std::pair(urscript, ""), std::pair(fanuc_tp, "/PROG A\n/MN\n/POS\n")}) {
      try {
        (void)parse_program(language, head + many(piece), "f");
      } catch (const DataError&) {
      }
    }
}

}  // namespace
}  // namespace vernier::robot_damage_test
