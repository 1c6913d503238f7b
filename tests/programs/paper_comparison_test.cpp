// SPDX-License-Identifier: BSD-3-Clause
// Runs the program with small settings, as a user would.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/frames.hpp"
#include "vernier/kinematics/robots.hpp"

namespace paper_comparison_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

const std::vector<std::string> names{"uncompensated",    "joint_ga_elm",      "joint_pso_elm",
                                     "cartesian_ga_elm", "cartesian_pso_elm", "identification"};
const std::string few = " --train 300 --test 60 --scale-budget 0.02 --seed 3 ", small = few + "--fresh 40 ";

CommandResult run(const TemporaryFolder& folder, const std::string& arguments, const std::string& environment = "") {
  const std::string program = std::string(VERNIER_EXAMPLES_DIR) + "/paper_comparison";
  return vernier_test::run_command(
      "cd '" + folder.path().string() + "'; " + environment + " '" + program + "' " + arguments, folder.path());
}

struct Outcome {
  CommandResult command;
  Json json;
};

Outcome run_to_json(const std::string& arguments, const std::string& size = small) {
  const TemporaryFolder folder("paper_comparison");
  const auto file = folder / "result.json";
  CommandResult command = run(folder, size + arguments + " --json '" + file.string() + "'");
  EXPECT_EQ(command.exit_code, 0) << command.errors;
  return {command, command.exit_code == 0 ? Json::parse(vernier::read_file(file)) : Json()};
}

/// The run that several tests look at.
const Outcome& plain() {
  static const Outcome outcome = run_to_json("--threads 1 --runs 2");
  return outcome;
}

const Json& method(const Outcome& outcome, const char* set, const std::string& name) {
  return outcome.json.at("sets").at(set).at("methods").at(name);
}

TEST(PaperComparison, SameBitsForAnyNumberOfThreads) {
  Json one = plain().json, three = run_to_json("--threads 3 --runs 2").json;
  ASSERT_EQ(one.erase("seconds"), 1u);
  ASSERT_EQ(three.erase("seconds"), 1u);
  EXPECT_EQ(one.dump(), three.dump());
}

TEST(PaperComparison, JsonHasTheStatedMembers) {
  const Json& json = plain().json;
  EXPECT_EQ(json.at("robot"), "abb_irb120");
  EXPECT_EQ(json.at("seed"), 3);
  ASSERT_EQ(json.at("sets").size(), 2u);
  EXPECT_EQ(json.at("sets").at("test").at("n"), 60);
  EXPECT_EQ(json.at("sets").at("random").at("n"), 40);
  for (const char* set : {"test", "random"}) {
    ASSERT_EQ(json.at("sets").at(set).at("methods").size(), names.size());
    const double before = method(plain(), set, "uncompensated").at("mean_mm");
    for (const auto& name : names) {
      const Json& m = method(plain(), set, name);
      const double mean = m.at("mean_mm"), max = m.at("max_mm"), min = m.at("min_mm"), rms = m.at("rms_mm"),
                   p95 = m.at("p95_mm");
      EXPECT_TRUE(0 <= min && min <= mean && mean <= rms && rms <= max && p95 <= max) << set << " " << name;
      EXPECT_NEAR(m.at("reduction_percent").get<double>(), 100 * (1 - mean / before), 1e-9) << set << " " << name;
      EXPECT_GT(m.at("mean_mrad").get<double>(), 0) << set << " " << name;
    }
  }
  ASSERT_EQ(json.at("seconds").size(), names.size() - 1);
  for (std::size_t m = 1; m < names.size(); ++m) EXPECT_GT(json.at("seconds").at(names[m]).get<double>(), 0);
}

TEST(PaperComparison, RunsAreSummedUp) {
  const Json& runs = plain().json.at("runs");
  EXPECT_EQ(runs.at("count"), 2);
  ASSERT_EQ(runs.at("each").size(), 2u);
  EXPECT_EQ(runs.at("each")[0].at("sets"), plain().json.at("sets"));
  EXPECT_NE(runs.at("each")[0].at("sets"), runs.at("each")[1].at("sets"));
  for (const char* set : {"test", "random"})
    for (std::size_t m = 1; m < names.size(); ++m) {
      const auto reduction = [&](std::size_t r) -> double {
        return runs.at("each")[r].at("sets").at(set).at("methods").at(names[m]).at("reduction_percent");
      };
      const Json& spread = runs.at("reduction_percent").at(set).at(names[m]);
      const double a = reduction(0), b = reduction(1);
      EXPECT_NEAR(spread.at("mean").get<double>(), (a + b) / 2, 1e-9);
      EXPECT_NEAR(spread.at("sd").get<double>(), std::abs(a - b) / std::sqrt(2.0), 1e-9);
      EXPECT_NEAR(spread.at("median").get<double>(), (a + b) / 2, 1e-9);
      EXPECT_EQ(spread.at("min").get<double>(), std::min(a, b));
      EXPECT_EQ(spread.at("max").get<double>(), std::max(a, b));
    }
}

TEST(PaperComparison, LearningHelpsAndIdentificationIsExact) {
  for (const char* set : {"test", "random"}) {
    // parameters off by 1 mm and 1 to 3 mrad on an arm of 0.6 m
    EXPECT_GT(method(plain(), set, "uncompensated").at("mean_mm").get<double>(), 0.5) << set;
    EXPECT_LT(method(plain(), set, "uncompensated").at("mean_mm").get<double>(), 10) << set;
    for (const char* name : {"joint_ga_elm", "joint_pso_elm", "cartesian_ga_elm", "cartesian_pso_elm"})
      EXPECT_GT(method(plain(), set, name).at("reduction_percent").get<double>(), 40) << set << " " << name;
    // the correction stops at 0.001 mm
    EXPECT_LT(method(plain(), set, "identification").at("max_mm").get<double>(), 2e-3) << set;
  }
}

TEST(PaperComparison, TablesNameEveryMethodAndThePaperBeside) {
  const std::string& output = plain().command.output;
  for (const char* text :
       {"uncompensated", "joint-space GA-ELM", "joint-space PSO-ELM", "Cartesian GA-ELM", "Cartesian PSO-ELM",
        "identification", "test set, 60 poses", "random set, 40 poses", "[mm]", "[mrad]", "95.06", "94.88", "REDUCED",
        "over 2 error tables and seeds", "Seconds on 1 thread"})
    EXPECT_NE(output.find(text), std::string::npos) << text << " is missing in\n" << output;
  EXPECT_EQ(output.find('\x1b'), std::string::npos) << "no progress bar where nobody looks";
  EXPECT_EQ(plain().command.errors, "");
}

TEST(PaperComparison, EachOptionActsOnWhatItNames) {
  const Json base = plain().json.at("runs").at("each")[0].at("sets").at("test").at("methods");
  const auto changed = [&](const std::string& arguments, const std::string& size = small) {
    const Outcome outcome = run_to_json("--threads 2 " + arguments, size);
    std::vector<std::string> out;
    for (const auto& name : names)
      if (method(outcome, "test", name) != base.at(name)) out.push_back(name);
    return out;
  };
  EXPECT_EQ(changed(""), std::vector<std::string>{}) << "one run is the first of two";
  EXPECT_EQ(changed("--positions clamped"), (std::vector<std::string>{"joint_pso_elm", "cartesian_pso_elm"}));
  EXPECT_EQ(changed("--noise-mm 0.1"),
            (std::vector<std::string>{"cartesian_ga_elm", "cartesian_pso_elm", "identification"}));
  EXPECT_EQ(changed("--fresh 41", few), std::vector<std::string>{});
  EXPECT_EQ(changed("--region full"), names);
}

TEST(PaperComparison, VarProAddsTwoMethodsAndChangesNoOther) {
  const Outcome with = run_to_json("--threads 1 --varpro");
  const Json& before = plain().json.at("runs").at("each")[0].at("sets").at("test").at("methods");
  ASSERT_EQ(with.json.at("sets").at("test").at("methods").size(), names.size() + 2);
  for (const auto& name : names) EXPECT_EQ(method(with, "test", name), before.at(name)) << name;
  for (const char* name : {"cartesian_var_pro_elm", "cartesian_var_pro_elm_sin_cos"}) {
    EXPECT_GT(method(with, "test", name).at("reduction_percent").get<double>(), 40) << name;
    EXPECT_GT(with.json.at("seconds").at(name).get<double>(), 0) << name;
  }
  EXPECT_NE(with.command.output.find("Cartesian VarProElm"), std::string::npos);
  EXPECT_EQ(plain().command.output.find("VarProElm"), std::string::npos);
}

TEST(PaperComparison, FiguresAreWholeAndTheProgramGoesOnWithoutGnuplot) {
  const TemporaryFolder folder("paper_comparison");
  const CommandResult without = run(folder, small, "PATH=/nonexistent");
  EXPECT_EQ(without.exit_code, 0);
  EXPECT_EQ(without.errors, "gnuplot is not installed: going on without figures\n");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "paper_comparison_out"));
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const CommandResult with = run(folder, small);
  EXPECT_EQ(with.exit_code, 0) << with.errors;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "paper_comparison_out")) {
    const std::string svg = vernier::read_file(entry.path());
    EXPECT_EQ(entry.path().extension(), ".svg");
    EXPECT_NE(svg.find("<svg"), std::string::npos) << entry.path();
    EXPECT_NE(svg.rfind("</svg>"), std::string::npos) << entry.path();
    EXPECT_NE(svg.find("Cartesian PSO-ELM"), std::string::npos) << entry.path();
    EXPECT_NE(with.output.find(entry.path().filename().string()), std::string::npos) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 5u);
}

TEST(PaperComparison, WritesPosesForCalibration) {
  const TemporaryFolder folder("paper_comparison");
  const auto file = folder / "poses.csv";
  const CommandResult command = run(folder, small + "--write-poses '" + file.string() + "'");
  ASSERT_EQ(command.exit_code, 0) << command.errors;
  const auto data = vernier::read_dataset<6>(file);
  EXPECT_EQ(data.size(), 300);
  ASSERT_TRUE(data.has_orientations());
  const auto chain = vernier::robots::abb_irb120().chain;
  EXPECT_GT(vernier::prediction_error(chain, data).mean, 1) << "the tracker stands elsewhere";
  const auto arm = vernier::starting_frames(chain, data, true, true);
  const double registered = vernier::prediction_error(arm, data).mean;
  EXPECT_LT(registered, 5e-3) << "once frames are registered, the arm's own errors are left";
  EXPECT_GT(registered, 0.1e-3);
  EXPECT_GT(arm.tool().translation().norm(), 0.1);
}

TEST(PaperComparison, WrongUsageIsTwoAndOneLine) {
  const TemporaryFolder folder("paper_comparison");
  for (const char* arguments :
       {"--bogus", "--train", "--train 0", "--test -1", "--fresh x", "--runs 0", "--threads 0", "--seed -1",
        "--region elsewhere", "--positions", "--scale-budget 0", "--scale-budget nan", "--noise-mm -1", "surplus"}) {
    const CommandResult command = run(folder, arguments);
    EXPECT_EQ(command.exit_code, 2) << arguments;
    EXPECT_TRUE(command.one_line_of_errors()) << arguments << ": " << command.errors;
    EXPECT_EQ(command.errors.find("paper_comparison: "), 0u) << command.errors;
    EXPECT_EQ(command.output, "") << arguments;
  }
}

TEST(PaperComparison, WhatCannotBeWrittenIsOneAndOneLineBeforeAnyWork) {
  const TemporaryFolder folder("paper_comparison");
  const std::string missing = (folder / "missing").string(), here = folder.path().string();
  for (const std::string& arguments : {"--json '" + missing + "/a.json'", "--json '" + here + "'",
                                       "--write-poses '" + missing + "/a.csv'", std::string("--out /dev/null")}) {
    const CommandResult command = run(folder, arguments);  // full size: would take minutes if it started
    EXPECT_EQ(command.exit_code, 1) << arguments;
    EXPECT_TRUE(command.one_line_of_errors()) << arguments << ": " << command.errors;
    EXPECT_EQ(command.output, "") << arguments;
  }
}

TEST(PaperComparison, HelpListsTheOptions) {
  const TemporaryFolder folder("paper_comparison");
  const CommandResult command = run(folder, "--help");
  EXPECT_EQ(command.exit_code, 0);
  for (const char* option :
       {"--help", "--json", "--seed", "--threads", "--out", "--quick", "--runs", "--region", "--positions", "--train",
        "--test", "--fresh", "--scale-budget", "--noise-mm", "--write-poses"})
    EXPECT_NE(command.output.find(option), std::string::npos) << option;
}

}  // namespace
}  // namespace paper_comparison_test
