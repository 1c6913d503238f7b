// SPDX-License-Identifier: BSD-3-Clause
// Targets replaced in place: what is written is read again, everything else keeps its bytes.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <sstream>

#include "complaint.hpp"
#include "robot_program_samples.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/robot_programs/configuration.hpp"
#include "vernier/robot_programs/robot_program.hpp"

namespace vernier::robot_replace_test {
namespace {

using namespace vernier_test;

std::vector<ProgramSample> all_samples() {
  return {rapid_sample(), krl_sample(), krl_source_sample(), urscript_sample(), fanuc_sample()};
}

/// The text without the numbers of its targets.
std::string without_numbers(const std::string& text, const RobotProgram& program) {
  std::vector<ByteRange> ranges;
  for (const ProgramTarget& target : program.targets) {
    ranges.insert(ranges.end(), target.numbers.begin(), target.numbers.end());
    ranges.insert(ranges.end(), target.configuration_numbers.begin(), target.configuration_numbers.end());
  }
  std::sort(ranges.begin(), ranges.end(), [](const ByteRange& a, const ByteRange& b) { return a.begin > b.begin; });
  std::string out = text;
  for (const ByteRange& range : ranges) out.replace(range.begin, range.end - range.begin, "#");
  return out;
}

Isometry3 random_pose(Rng& rng, int kind) {
  Isometry3 out = Isometry3::Identity();
  out.translation() = Vector3(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2));
  Vector3 r(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  r *= rng.uniform(0, std::numbers::pi) / r.norm();
  if (kind == 1) r = Vector3(0, std::numbers::pi / 2, 0);          // B = 90 degrees
  if (kind == 2) r *= (std::numbers::pi - 1e-7) / r.norm();        // nearly half a turn
  if (kind == 3) r = Vector3(0, -std::numbers::pi / 2 + 1e-6, 0);  // nearly B = -90 degrees
  if (kind == 4) r.setZero();
  out.linear() = exp_so3(r);
  return out;
}

TEST(ReplaceTargets, NothingReplacedKeepsEveryByte) {
  for (const ProgramSample& sample : all_samples())
    EXPECT_EQ(replace_targets(sample.text, parse_program(sample.language, sample.text, sample.name), {}), sample.text);
}

TEST(ReplaceTargets, WhatIsWrittenIsRead) {
  Rng rng(3);
  for (const ProgramSample& sample : all_samples()) {
    SCOPED_TRACE(sample.name);
    const RobotProgram program = parse_program(sample.language, sample.text, sample.name);
    for (int round = 0; round < 50; ++round) {
      std::vector<ReplacedTarget> replaced;
      for (std::size_t k = 0; k < program.targets.size(); ++k) {
        ReplacedTarget one{k, random_pose(rng, round % 6), {}};
        for (int j = 0; j < 6; ++j) one.joints(j) = rng.uniform(-6, 6);
        replaced.push_back(one);
      }
      const std::string text = replace_targets(sample.text, program, replaced);
      const RobotProgram again = parse_program(sample.language, text, sample.name);
      ASSERT_EQ(again.targets.size(), program.targets.size());
      EXPECT_EQ(without_numbers(text, again), without_numbers(sample.text, program));
      for (std::size_t k = 0; k < again.targets.size(); ++k) {
        const ProgramTarget& target = again.targets[k];
        EXPECT_EQ(target.line, program.targets[k].line);
        if (target.kind == TargetKind::joints) {
          EXPECT_LT((target.joints - replaced[k].joints).cwiseAbs().maxCoeff(), 1e-6);
          continue;
        }
        const Vector6 left = pose_difference(target.pose, replaced[k].pose);
        EXPECT_LT(left.head<3>().norm(), 1e-6);
        EXPECT_LT(left.tail<3>().norm(), 1e-6);
        EXPECT_EQ(target.configuration,
                  program.targets[k].configuration.empty()
                      ? std::vector<int>{}
                      : updated_configuration(sample.language, program.targets[k].configuration, replaced[k].joints));
      }
    }
  }
}

TEST(ReplaceTargets, NumbersAsTheControllersWriteThem) {
  const ProgramSample sample = rapid_sample();
  const RobotProgram program = parse_program(sample.language, sample.text, sample.name);
  const auto p10 = static_cast<std::size_t>(
      std::find_if(program.targets.begin(), program.targets.end(), [](const auto& t) { return t.name == "p10"; }) -
      program.targets.begin());
  ReplacedTarget one{p10, program.targets[p10].pose, JointVector<6>{0.1, -0.1, 0, -0.1, 0.3, 1.6}};
  one.pose.translation() = Vector3(0.60051234, -1e-9, 0);
  const std::string text = replace_targets(sample.text, program, std::span(&one, 1));
  EXPECT_NE(text.find("p10:=[[600.5123,0.0000,0.0000],[0.707106781,0.000000000,0.707106781,0.000000000],[0,-1,1,1],"
                      "[9E+09,"),
            std::string::npos)
      << text;
}

TEST(ReplaceTargets, ANumberDoesNotJoinTheWordBeforeIt) {
  const std::string text = "DEF m()\nPTP {X-1,Y-2,Z.5,A-4,B 5,C 6}\nEND\n";
  const RobotProgram program = parse_program(ProgramLanguage::krl, text, "m.src");
  ASSERT_EQ(program.targets.size(), 1u);
  EXPECT_LT((program.targets[0].pose.translation() - Vector3(-0.001, -0.002, 0.0005)).norm(), 1e-15);
  ReplacedTarget one{0, program.targets[0].pose, JointVector<6>::Zero()};
  one.pose.translation() = Vector3(0.001, 0.002, 0.003);
  EXPECT_NE(
      replace_targets(text, program, std::span(&one, 1)).find("{X 1.0000,Y 2.0000,Z 3.0000,A -4.000000,B 5.000000,"),
      std::string::npos);
}

TEST(ReplaceTargets, RefusesWhatCannotBeWritten) {
  const ProgramSample sample = rapid_sample();
  const RobotProgram program = parse_program(sample.language, sample.text, sample.name);
  ReplacedTarget one{99, Isometry3::Identity(), JointVector<6>::Zero()};
  EXPECT_EQ(complaint([&] { (void)replace_targets(sample.text, program, std::span(&one, 1)); }),
            "replace_targets: no target 99");
  one.target = 0;
  one.joints(2) = std::nan("");
  EXPECT_EQ(complaint([&] { (void)replace_targets(sample.text, program, std::span(&one, 1)); }),
            "replace_targets: target 0 is not finite");
  one.joints(2) = 0;
  const std::vector<ReplacedTarget> twice{one, one};
  EXPECT_EQ(complaint([&] { (void)replace_targets(sample.text, program, twice); }),
            "replace_targets: a target is there twice");
}

TEST(Stamped, AProgramIsCorrectedOnce) {
  for (const ProgramSample& sample : all_samples()) {
    SCOPED_TRACE(sample.name);
    const RobotProgram program = parse_program(sample.language, sample.text, sample.name);
    const std::string text =
        stamped(sample.text, program, {"model a.json; \xFF\n!", "sha256 0123456789012345678901234567890123456789"});
    EXPECT_NE(complaint([&] {
                (void)parse_program(sample.language, text, sample.name);
              }).find(": this program was corrected before; correct the original one"),
              std::string::npos);
    // All other bytes stay, and the comment lines are ones of the language.
    const std::size_t length = text.size() - sample.text.size();
    EXPECT_EQ(text.substr(0, program.stamp_at) + text.substr(program.stamp_at + length), sample.text);
    std::istringstream lines(text.substr(program.stamp_at, length));
    for (std::string line; std::getline(lines, line);) {
      if (line.ends_with('\r')) line.pop_back();
      if (sample.language == ProgramLanguage::fanuc_tp) {
        EXPECT_EQ(line.find("   :  !"), 0u) << line;
        EXPECT_LE(line.size(), 7u + 32 + 1) << line;
        EXPECT_EQ(line.find(';'), line.size() - 1) << line;
      } else {
        EXPECT_EQ(line[0], sample.language == ProgramLanguage::rapid ? '!'
                           : sample.language == ProgramLanguage::krl ? ';'
                                                                     : '#');
      }
      for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~');
    }
  }
}

}  // namespace
}  // namespace vernier::robot_replace_test
