// SPDX-License-Identifier: BSD-3-Clause
// A comparison shared out over ranks of mpirun, and results of several machines made one.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "run_command.hpp"
#include "temporary_folder.hpp"

namespace compare_ranks_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier::read_file;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

const std::string program = std::string(VERNIER_EXAMPLES_DIR) + "/compare";

CommandResult shell(const TemporaryFolder& folder, const std::string& command) {
  return vernier_test::run_command("cd '" + folder.path().string() + "'; " + command, folder.path());
}

CommandResult alone(const TemporaryFolder& folder, const std::string& arguments) {
  return shell(folder, "'" + program + "' " + arguments);
}

/// The lines of a results file without times, in alphabetical order.
std::multiset<std::string> cells(const std::string& text) {
  std::multiset<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    Json entry = Json::parse(line);
    entry["outcome"].erase("seconds");
    if (entry["outcome"].contains("convergence")) entry["outcome"]["convergence"].erase("seconds");
    out.insert(entry.dump());
  }
  return out;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(line);
  return out;
}

/// Twelve cells in a file, and what one process says of them.
struct Twelve {
  TemporaryFolder folder{"compare_ranks"};
  std::string grid = "--methods none,geometry,pso:elm --poses 30,60 --seeds 1,2 --evaluations 200 --nodes 10 ";
  CommandResult command = alone(folder, grid + "--threads 1 --results one.jsonl --json one.json");
  std::string results = command.exit_code == 0 ? read_file(folder / "one.jsonl") : "";
};
const Twelve& twelve() {
  static const Twelve once;
  return once;
}

#ifdef VERNIER_MPIEXEC

/// A line for the shell that starts ranks, also as root and more of them than there are processors.
std::string mpirun(int ranks, const std::string& command) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
         "OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl_vader_single_copy_mechanism=none "
         "PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe '" VERNIER_MPIEXEC "' -n " +
         std::to_string(ranks) + " " + command;
}

CommandResult ranks(int count, const TemporaryFolder& folder, const std::string& arguments) {
  return shell(folder, mpirun(count, "'" + program + "' " + arguments));
}

TEST(CompareRanks, TheSameCellsAndNumbersAsAlone) {
  ASSERT_EQ(twelve().command.exit_code, 0) << twelve().command.errors;
  for (const char* threads : {"", "--threads 2 "}) {
    const TemporaryFolder folder("compare_ranks");
    const CommandResult three = ranks(3, folder, twelve().grid + threads + "--results r.jsonl --json r.json");
    ASSERT_EQ(three.exit_code, 0) << three.errors;
    EXPECT_NE(three.output.find("12 cells, 12 of them to be computed by 3 ranks"), std::string::npos) << three.output;
    EXPECT_EQ(three.output.find("Average rank"), three.output.rfind("Average rank"));  // one of them prints
    EXPECT_EQ(cells(read_file(folder / "r.jsonl")), cells(twelve().results));
    EXPECT_EQ(read_file(folder / "r.json"), read_file(twelve().folder / "one.json"));
    EXPECT_FALSE(std::filesystem::exists(folder / "r.jsonl.rank1"));
    EXPECT_FALSE(std::filesystem::exists(folder / "r.jsonl.rank2"));
  }
}

TEST(CompareRanks, OneComplaint) {
  const TemporaryFolder folder("compare_ranks");
  const CommandResult refused = ranks(3, folder, "--methods elmo");
  EXPECT_EQ(refused.exit_code, 2);
  const auto at = refused.errors.find("no learner is called 'elmo'");
  EXPECT_NE(at, std::string::npos) << refused.errors;
  EXPECT_EQ(at, refused.errors.rfind("no learner is called 'elmo'")) << refused.errors;
}

// A failure on another rank is in the table of the first, and is no result.
TEST(CompareRanks, FailuresAreTold) {
  const TemporaryFolder folder("compare_ranks");
  const CommandResult failed = shell(
      folder, mpirun(2, "sh -c 'ulimit -v 700000; exec \"$0\" \"$@\"' '" + program +
                            "' --methods elm,kernel_elm --poses 9000 --seeds 1,2 --results r.jsonl --json r.json"));
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_NE(failed.output.find("(2 failed: out of memory)"), std::string::npos) << failed.output << failed.errors;
  EXPECT_EQ(lines_of(read_file(folder / "r.jsonl")).size(), 2u);
}

// The second of three ranks is killed after its first cell. What is done is on disk, and a rerun by other ranks, or by
// none, computes the rest alone.
TEST(CompareRanks, GoOnAfterADeath) {
  const std::string grid =
      "--methods pso:elm,geometry --poses 200 --seeds 1,2,3,4,5,6,7,8,9,10 --evaluations 3000 --nodes 30 ";
  const TemporaryFolder folder("compare_ranks");
  std::ofstream(folder / "mortal.sh") << R"sh(
if [ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" != 1 ]; then exec "$@"; fi
"$@" &
rank=$!
while kill -0 $rank && [ "$(cat r.jsonl.rank1 2>/dev/null | wc -l)" -lt 1 ]; do sleep 0.01; done
kill -9 $rank
wait $rank
)sh";
  const CommandResult killed = shell(folder, mpirun(3, "sh mortal.sh '" + program + "' " + grid + "--results r.jsonl"));
  EXPECT_NE(killed.exit_code, 0);
  ASSERT_TRUE(std::filesystem::exists(folder / "r.jsonl.rank1"));
  std::size_t whole = 0;  // lines that have an end
  for (const char* name : {"r.jsonl", "r.jsonl.rank1", "r.jsonl.rank2"}) {
    if (!std::filesystem::exists(folder / name)) continue;
    const std::string text = read_file(folder / name);
    whole += static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  ASSERT_GE(whole, 1u);
  ASSERT_LT(whole, 20u);
  const CommandResult rest = ranks(2, folder, grid + "--results r.jsonl");
  ASSERT_EQ(rest.exit_code, 0) << rest.errors;
  EXPECT_NE(rest.output.find("20 cells, " + std::to_string(20 - whole) + " of them"), std::string::npos) << rest.output;
  ASSERT_EQ(alone(folder, grid + "--results one.jsonl").exit_code, 0);
  EXPECT_EQ(cells(read_file(folder / "r.jsonl")), cells(read_file(folder / "one.jsonl")));
}

#endif

// What ranks left behind is taken in by any run, a line that was cut off and cells that are there already aside.
TEST(CompareRanks, WhatIsLeftIsTakenIn) {
  const auto lines = lines_of(twelve().results);
  ASSERT_EQ(lines.size(), 12u);
  const TemporaryFolder folder("compare_ranks");
  std::ofstream(folder / "r.jsonl") << lines[0] << '\n' << lines[1] << '\n';
  std::ofstream(folder / "r.jsonl.rank7") << lines[1] << '\n' << lines[2] << '\n' << lines[3].substr(0, 50);
  std::ofstream(folder / "r.jsonl.rankle") << "not ours";
  const CommandResult rest = alone(folder, twelve().grid + "--results r.jsonl --json r.json");
  ASSERT_EQ(rest.exit_code, 0) << rest.errors;
  EXPECT_NE(rest.output.find("12 cells, 9 of them"), std::string::npos) << rest.output;
  EXPECT_FALSE(std::filesystem::exists(folder / "r.jsonl.rank7"));
  EXPECT_TRUE(std::filesystem::exists(folder / "r.jsonl.rankle"));
  EXPECT_EQ(cells(read_file(folder / "r.jsonl")), cells(twelve().results));
  EXPECT_EQ(read_file(folder / "r.json"), read_file(twelve().folder / "one.json"));
}

// Files of several machines: a cell in both once, another plan's cells too, a line that was cut off not.
TEST(CompareMerge, MakesOneFileOfSeveral) {
  const auto lines = lines_of(twelve().results);
  ASSERT_EQ(lines.size(), 12u);
  const TemporaryFolder folder("compare_ranks");
  std::ofstream a(folder / "a.jsonl"), b(folder / "b.jsonl");
  for (std::size_t k = 0; k < 7; ++k) a << lines[k] << '\n';
  Json other = Json::parse(lines[0]);
  other["cell"]["nodes"] = 11;
  b << other.dump() << '\n';
  for (std::size_t k = 5; k < 12; ++k) {
    Json entry = Json::parse(lines[k]);
    entry["outcome"]["seconds"] = 1e-3;  // of another machine
    b << entry.dump() << '\n';
  }
  b << lines[3].substr(0, 100);
  a.close();
  b.close();
  const CommandResult merged = alone(folder, "--merge a.jsonl b.jsonl --results all.jsonl");
  ASSERT_EQ(merged.exit_code, 0) << merged.errors;
  EXPECT_EQ(merged.output,
            "a.jsonl: 7 cells\n"
            "b.jsonl: 8 cells, 2 of them there already with the same numbers\n"
            "b.jsonl, line 9: the last line is cut off and left out\n"
            "all.jsonl: 13 cells in all\n");
  // with a plan it goes on with the tables
  const CommandResult tables =
      alone(folder, twelve().grid + "--merge a.jsonl b.jsonl --results all.jsonl --json r.json");
  ASSERT_EQ(tables.exit_code, 0) << tables.errors;
  EXPECT_NE(tables.output.find("all.jsonl: 13 cells in all\n1 of the cells in it belong to other plans\n"
                               "12 cells, 0 of them to be computed"),
            std::string::npos)
      << tables.output;
  EXPECT_EQ(read_file(folder / "r.json"), read_file(twelve().folder / "one.json"));
}

TEST(CompareMerge, RefusesWhatContradictsItself) {
  const auto lines = lines_of(twelve().results);
  ASSERT_EQ(lines.size(), 12u);
  const TemporaryFolder folder("compare_ranks");
  Json entry = Json::parse(lines[3]);
  entry["outcome"]["mean"] = 0.5;
  std::ofstream(folder / "a.jsonl") << twelve().results;
  std::ofstream(folder / "b.jsonl") << lines[2] << '\n' << entry.dump() << '\n';
  std::ofstream(folder / "c.jsonl") << lines[2] << "\nnot a result\n";
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const CommandResult result = alone(folder, arguments + " --results all.jsonl");
    EXPECT_EQ(result.exit_code, 1) << arguments;
    EXPECT_TRUE(result.one_line_of_errors()) << arguments << '\n' << result.errors;
    EXPECT_NE(result.errors.find(words), std::string::npos) << arguments << '\n' << result.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "all.jsonl")) << arguments;
  };
  refused("--merge a.jsonl b.jsonl", "b.jsonl, line 2: the cell of a.jsonl, line 4 with another outcome");
  refused("--merge a.jsonl c.jsonl", "c.jsonl, line 2: no result of a comparison");
  refused("--merge a.jsonl d.jsonl", "d.jsonl: No such file");
}

// Searches that end by time give other numbers each time; the first is kept.
TEST(CompareMerge, KeepsTheFirstOfWhatTimeDecided) {
  Json entry = Json::parse(lines_of(twelve().results).front());
  entry["cell"]["seconds_allowed"] = 2.0;
  const TemporaryFolder folder("compare_ranks");
  std::ofstream(folder / "a.jsonl") << entry.dump() << '\n';
  entry["outcome"]["mean"] = 0.5;
  std::ofstream(folder / "b.jsonl") << entry.dump() << '\n';
  const CommandResult merged = alone(folder, "--merge a.jsonl b.jsonl --results all.jsonl");
  ASSERT_EQ(merged.exit_code, 0) << merged.errors;
  EXPECT_NE(merged.output.find("b.jsonl: 1 cell whose searches end by time is there already, with other numbers: the "
                               "first outcome is kept\n"),
            std::string::npos)
      << merged.output;
  EXPECT_EQ(read_file(folder / "all.jsonl"), read_file(folder / "a.jsonl"));
}

// What was written by hand, or by a program of ours that wrote null for infinity.
TEST(CompareResults, LinesOfTheWrongKind) {
  const TemporaryFolder folder("compare_ranks");
  const auto with = [&](const std::string& outcome) {
    std::ofstream(folder / "r.jsonl") << R"({"cell": {"seed": 1}, "outcome": )" << outcome << "}\n";
    return alone(folder, "--merge r.jsonl --results all.jsonl");
  };
  const std::string numbers =
      R"("mean": 1, "median": 1, "rms": 1, "p95": 1, "max": 1, "before": 1, "seconds": 1, "learned_from": 1)";
  EXPECT_EQ(with("{" + numbers + R"(, "convergence": {"evaluations": [1], "seconds": [1], "best": [null]}})").exit_code,
            0);
  for (const auto& [outcome, words] : std::map<std::string, std::string>{
           {"{}", "(mean must be a number)"},
           {"[1]", "(the outcome must be an object)"},
           {R"({"failure": "no"})", "(failures are not kept)"},
           {"{" + numbers + R"(, "quantiles": 3})", "(quantiles must be a list of numbers)"},
           {"{" + numbers + R"(, "convergence": {"evaluations": [1]}})", "(convergence must have seconds)"},
           {"{" + numbers + R"(, "convergence": {"evaluations": [1], "seconds": [1], "best": []}})",
            "(the lists of convergence must have one length)"}}) {
    const CommandResult result = with(outcome);
    EXPECT_EQ(result.exit_code, 1) << outcome;
    EXPECT_TRUE(result.one_line_of_errors()) << result.errors;
    EXPECT_NE(result.errors.find("r.jsonl, line 1: no result of a comparison " + words), std::string::npos)
        << result.errors;
  }
}

}  // namespace
}  // namespace compare_ranks_test
