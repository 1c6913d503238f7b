// SPDX-License-Identifier: BSD-3-Clause
// The comparison program: the same figures twice, goes on where it stopped, refuses what it does not know.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace compare_test {
namespace {

using Json = nlohmann::ordered_json;
using vernier::read_file;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

CommandResult run(const TemporaryFolder& folder, const std::string& arguments) {
  const std::string program = std::string(VERNIER_EXAMPLES_DIR) + "/compare";
  return vernier_test::run_command("cd '" + folder.path().string() + "'; '" + program + "' " + arguments,
                                   folder.path());
}

const std::string grid =
    "--methods none,geometry,elm,ridge_elm,pso:elm,geometry+ga:ridge_elm --poses 40,80 --seeds 1,2,3 --evaluations 200 "
    "--nodes 15 --noise-mm 0.03 --errors full ";

/// The grid that several tests look at, with one thread.
struct First {
  TemporaryFolder folder{"compare"};
  CommandResult command = run(folder, grid + "--threads 1 --json result.json");
  Json json = command.exit_code == 0 ? Json::parse(read_file(folder / "result.json")) : Json();
  std::string results = command.exit_code == 0 ? read_file(folder / "compare_out/results.jsonl") : "";
};
const First& first() {
  static const First once;
  return once;
}

/// Mean errors of a method by seed.
std::vector<double> means(const Json& json, std::size_t table, const std::string& method) {
  return json.at("problems").at(table).at("methods").at(method).at("means_mm").get<std::vector<double>>();
}

TEST(Compare, LearnsWhatAJointWiseModelLeaves) {
  const TemporaryFolder folder("compare");
  const CommandResult found = run(folder,
                                  "--methods none,jointwise,jointwise+gp --poses 60 --seeds 1,2 --errors full "
                                  "--noise-mm 0.03 --threads 1 --json result.json");
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  const Json json = Json::parse(read_file(folder / "result.json"));
  const auto base = means(json, 0, "jointwise"), both = means(json, 0, "jointwise+gp"), none = means(json, 0, "none");
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_LT(base[s], 0.1 * none[s]);
    EXPECT_NE(both[s], base[s]);
    EXPECT_LT(both[s], 1.5 * base[s]);  // there is hardly anything left to learn, and a process knows it
  }
}

TEST(Compare, TablesHaveEveryCell) {
  ASSERT_EQ(first().command.exit_code, 0) << first().command.errors;
  ASSERT_EQ(first().json.at("problems").size(), 2u);
  for (std::size_t table = 0; table < 2; ++table) {
    ASSERT_EQ(first().json.at("problems")[table].at("methods").size(), 6u);
    const auto before = means(first().json, table, "none");
    for (const auto& [name, method] : first().json.at("problems")[table].at("methods").items()) {
      const auto errors = means(first().json, table, name);
      ASSERT_EQ(errors.size(), 3u);
      auto sorted = errors;
      std::sort(sorted.begin(), sorted.end());
      EXPECT_EQ(method.at("median_mm"), sorted[1]);
      EXPECT_EQ(method.at("failures"), 0);
      for (std::size_t s = 0; s < 3 && name != "none"; ++s) EXPECT_LT(errors[s], before[s]) << name;
    }
    // geometric errors are most of what there is
    EXPECT_LT(means(first().json, table, "geometry")[0], 0.5 * before[0]);
  }
  EXPECT_EQ(std::count(first().results.begin(), first().results.end(), '\n'), 36);
  EXPECT_NE(first().command.output.find("36 cells, 36 of them to be computed"), std::string::npos);
}

TEST(Compare, SameBitsTwiceAndForAnyNumberOfThreads) {
  const TemporaryFolder folder("compare");
  const CommandResult again = run(folder, grid + "--threads 3 --json result.json");
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_EQ(read_file(folder / "result.json"), first().json.dump(2) + "\n");
}

// Killed in the middle of a line, the file is mended and what it has is not computed again.
TEST(Compare, GoesOnWhereItStopped) {
  const TemporaryFolder folder("compare");
  std::size_t cut = 0;
  for (int lines = 0; lines < 20; ++lines) cut = first().results.find('\n', cut) + 1;
  std::ofstream(folder / "part.jsonl", std::ios::binary) << first().results.substr(0, cut + 30);
  const CommandResult rest = run(folder, grid + "--results part.jsonl --json result.json");
  ASSERT_EQ(rest.exit_code, 0) << rest.errors;
  EXPECT_NE(rest.output.find("36 cells, 16 of them to be computed"), std::string::npos) << rest.output;
  EXPECT_EQ(read_file(folder / "result.json"), first().json.dump(2) + "\n");
  EXPECT_EQ(read_file(folder / "part.jsonl").substr(0, cut), first().results.substr(0, cut));
  // all there: nothing to do; another budget: the searches alone
  EXPECT_NE(run(folder, grid + "--results part.jsonl").output.find(" 0 of them"), std::string::npos);
  std::string other = grid;
  other.replace(other.find("--evaluations 200"), 17, "--evaluations 150");
  EXPECT_NE(run(folder, other + "--results part.jsonl").output.find(" 12 of them"), std::string::npos);
}

// What failed is told, is no result, and is tried again.
TEST(Compare, FailuresAreTriedAgain) {
  const TemporaryFolder folder("compare");
  // a kernel of 6,000 poses is a matrix of 288 MB
  const std::string command = "cd '" + folder.path().string() + "'; ulimit -v 250000; '" + VERNIER_EXAMPLES_DIR +
                              "/compare' --methods elm,kernel_elm --poses 6000 --seeds 1,2 --results r.jsonl "
                              "--json r.json";
  for (const char* words : {"4 cells, 4 of them", "4 cells, 2 of them"}) {
    const CommandResult result = vernier_test::run_command(command, folder.path());
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.output.find(words), std::string::npos) << result.output;
    EXPECT_NE(result.output.find("(2 failed: out of memory)"), std::string::npos) << result.output;
    EXPECT_NE(result.errors.find("compare: 2 of 4 cells failed"), std::string::npos) << result.errors;
    const Json methods = Json::parse(read_file(folder / "r.json")).at("problems")[0].at("methods");
    EXPECT_EQ(methods.at("kernel_elm").at("failures"), 2);
  }
  const std::string kept = read_file(folder / "r.jsonl");
  EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), 2);
}

// Results belong to the poses in a file, not to its name.
TEST(Compare, OtherPosesAreOtherCells) {
  const TemporaryFolder folder("compare");
  const auto robot = vernier::robots::abb_irb120();
  const auto write = [&](std::uint64_t seed) {
    const auto joints = vernier::abb_irb120_operating_region().sample(robot.chain, 50, seed);
    vernier::write_dataset(folder / "poses.csv",
                           vernier::measure(vernier::with_geometric_errors(robot.chain, {}, seed), joints, {}, seed));
  };
  const std::string arguments = "--methods none,geometry --data poses.csv --poses 20,0 --seeds 1,2";
  write(3);
  EXPECT_NE(run(folder, arguments).output.find("8 cells, 8 of them"), std::string::npos);
  EXPECT_NE(run(folder, arguments).output.find("8 cells, 0 of them"), std::string::npos);
  write(4);
  EXPECT_NE(run(folder, arguments).output.find("8 cells, 8 of them"), std::string::npos);
}

TEST(Compare, APlanSaysTheSameAsOptions) {
  const TemporaryFolder folder("compare");
  std::ofstream(folder / "plan.json") << R"({
    "problems": [{"name": "abb_irb120", "errors": "full", "noise_mm": 0.03}],
    "methods": ["none", "geometry", "elm", "ridge_elm", "pso:elm", "geometry+ga:ridge_elm"],
    "poses": [40, 80], "seeds": [1, 2, 3], "evaluations": 200, "nodes": 15})";
  std::ofstream(folder / "results.jsonl", std::ios::binary) << first().results;
  const CommandResult result = run(folder, "plan.json --results results.jsonl --json result.json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(" 0 of them"), std::string::npos);
  EXPECT_EQ(read_file(folder / "result.json"), first().json.dump(2) + "\n");
}

TEST(Compare, RefusesWhatItDoesNotKnow) {
  const TemporaryFolder folder("compare");
  std::ofstream(folder / "plan.json") << R"({"problems": [{"robot": "abb_irb120"}], "methods": ["elm"], "seed": [1]})";
  std::ofstream(folder / "none.jsonl") << "not a result\n";
  const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
    const CommandResult result = run(folder, arguments);
    EXPECT_EQ(result.exit_code, code) << arguments;
    EXPECT_TRUE(result.one_line_of_errors()) << arguments << '\n' << result.errors;
    EXPECT_NE(result.errors.find(words), std::string::npos) << arguments << '\n' << result.errors;
  };
  refused("", 2, "--methods or a plan is needed");
  refused("--methods elmo", 2, "no learner is called 'elmo'");
  refused("--methods psso:elm", 2, "no search is called 'psso'");
  refused("--methods elm@cosine", 2, "no input map is called 'cosine'");
  refused("--methods pso:geometry", 2, "geometry stands alone");
  refused("--methods jointwise+none", 2, "none stands alone");
  refused("--methods elm --robot ur99", 2, "no robot is called 'ur99'");
  refused("--methods elm --robot ur10 --region operating", 2, "only the abb_irb120 has an operating region");
  std::ofstream(folder / "free.json") << R"({"name": "free", "convention": "standard", "joints": [
    {"a_mm": 300, "alpha_deg": 0, "d_mm": 100, "theta_deg": 0, "lower_deg": -90, "upper_deg": 90},
    {"a_mm": 200, "alpha_deg": 90, "d_mm": 0, "theta_deg": 0}]})";
  refused("--methods elm --robot free.json", 2,
          "free.json: joint 2 has no lower_deg or no upper_deg; simulated poses need limits");
  refused("--methods elm --poses 0", 2, "simulated poses need a number");
  refused("--methods elm --evaluations 10", 2, "evaluations is 10");
  refused("plan.json", 2, "key 'seed' is unknown");
  refused("missing.json", 1, "missing.json");
  Json endless = Json::parse(R"({"problems": [{}], "methods": ["elm"]})");
  endless["poses"] = std::vector<int>(4000, 10);
  endless["seeds"] = std::vector<int>(4000, 1);
  std::ofstream(folder / "endless.json") << endless.dump();
  refused("endless.json", 2, "the grid has more than ten million cells");
  std::ofstream(folder / "twice.json") << R"({"problems": [{}], "methods": ["elm"], "methods": ["gp"]})";
  refused("twice.json", 1, "key 'methods' is given twice");
  refused("--methods elm --results none.jsonl", 1, "none.jsonl, line 1: no result of a comparison");
}

// Ten curves: their legend stands beside the plot, in one column.
TEST(Compare, LegendsOfManyCurvesLeaveTheDataAlone) {
  const TemporaryFolder folder("compare");
  std::string methods;
  const std::vector<std::string> searches{"random", "pso",     "pso_clamped", "pso_constriction", "spso2011",
                                          "ga",     "real_ga", "de",          "lshade",           "cmaes"};
  for (const std::string& search : searches) methods += (methods.empty() ? "" : ",") + search + ":elm";
  const CommandResult found =
      run(folder, "--methods " + methods + " --poses 20 --seeds 1 --evaluations 100 --nodes 5 --threads 1");
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  const std::string figure = read_file(folder / "compare_out/convergence_abb_irb120_elm.svg");
  std::set<std::string> places;  // of the texts' left ends
  for (const std::string& search : searches) {
    const std::size_t name = figure.find("<text>" + search + ":elm</text>");
    ASSERT_NE(name, std::string::npos) << search;
    const std::size_t at = figure.rfind("translate(", name) + 10;
    places.insert(figure.substr(at, figure.find(',', at) - at));
  }
  EXPECT_EQ(places.size(), 1u);
}

// An arm of which no region is known is simulated within its limits; columns of the table never touch.
TEST(Compare, OtherArmsAreSimulatedWithinTheirLimits) {
  const TemporaryFolder folder("compare");
  const CommandResult result = run(folder, "--methods none,geometry --robot ur10 --poses 40 --seeds 1,2");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("ur10, 40 poses to learn from"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("]0"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("] "), std::string::npos) << result.output;
}

TEST(Compare, ListsItsMethods) {
  const TemporaryFolder folder("compare");
  const CommandResult result = run(folder, "--list");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* name : {"jointwise", "ridge_elm", "pso"})
    EXPECT_NE(result.output.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace compare_test
