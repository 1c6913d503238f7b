// SPDX-License-Identifier: BSD-3-Clause
// Outputs of the programs: devices, pipes, links and standard output, and what is refused before any work.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::outputs_test {
namespace {

namespace fs = std::filesystem;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

class Outputs : public ::testing::Test {
 protected:
  Outputs() {
    const auto robot = robots::abb_irb120();
    const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 60, 3);
    const Framed<DhChain<6>> actual(with_geometric_errors(robot.chain, {}, 4));
    write_dataset(at("measured.csv"), measure(actual, joints, {.position = 3e-5, .with_orientations = false}, 4));
    std::string targets = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n";
    for (const char* row : {"0.1,0.2,0.1,0.3,0.5,0.1\n", "0.2,0.2,0.1,0.3,0.6,0.1\n"}) targets += row;
    write_file(at("targets.csv"), targets);
    using Model = CalibratedRobot<6>::Model;
    save(at("model.json"),
         CalibratedRobot<6>("an arm", Model(robot.chain, Model::Arm(actual.chain())), robot.limits, {}));
  }

  std::string at(const std::string& name) const { return folder_ / name; }

  /// Runs commands of bash in the folder, where $P is the folder of the programs.
  CommandResult run(const std::string& commands) const {
    write_file(streams_ / "commands.sh", "export P='" + std::string(VERNIER_EXAMPLES_DIR) + "'\ncd '" +
                                             folder_.path().string() + "'\n" + commands + "\n");
    return vernier_test::run_command("bash '" + (streams_ / "commands.sh").string() + "'", streams_.path());
  }

  /// That the commands are refused before any work: the exit code, one line with some words, and nothing written.
  void expect_refused(const std::string& commands, int exit_code, const std::string& words) const {
    const auto files = [&] {
      std::map<std::string, std::string> out;
      for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
        out[entry.path().string()] = entry.is_regular_file() ? read_file(entry.path()) : "";
      return out;
    };
    const auto before = files();
    const CommandResult result = run(commands);
    EXPECT_EQ(result.exit_code, exit_code) << commands << "\n" << result.errors;
    EXPECT_TRUE(result.one_line_of_errors()) << commands << "\n" << result.errors;
    EXPECT_NE(result.errors.find(words), std::string::npos) << commands << "\n" << result.errors;
    EXPECT_EQ(result.output, "") << commands;
    EXPECT_EQ(files(), before) << commands;
  }

  TemporaryFolder folder_{"outputs"}, streams_{"outputs_streams"};
};

const std::string simulate = "$P/simulate_measurements --robot abb_irb120 --poses targets.csv ";
const std::string correct = "$P/correct --model model.json --targets targets.csv ";

TEST_F(Outputs, DashIsStandardOutputWithoutAnythingElse) {
  for (const std::string& program : {simulate, correct, std::string("$P/export_c --model model.json "),
                                     std::string("$P/plan_poses --robot abb_irb120 --count 5 --candidates 50 "),
                                     std::string("$P/iso9283 --plan --centre-mm 600,0,500 --edge-mm 400 ")}) {
    const CommandResult to_file = run(program + "--out file");
    ASSERT_EQ(to_file.exit_code, 0) << program << to_file.errors;
    const std::string content = read_file(at("file"));
    for (const char* out : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
      const CommandResult result = run(program + "--out " + out);
      EXPECT_EQ(result.exit_code, 0) << program << out << result.errors;
      EXPECT_EQ(result.output, content) << program << out;
      EXPECT_NE(result.errors.find("standard output"), std::string::npos) << result.errors << "is for people";
    }
    EXPECT_EQ(run(program + "--out - | cat").output, content);
  }
  const CommandResult json = run(correct + "--out commands.csv --json -");
  EXPECT_EQ(nlohmann::json::parse(json.output)["targets"], 2);
  EXPECT_NE(json.errors.find("Commands: commands.csv"), std::string::npos) << json.errors;
}

TEST_F(Outputs, WhatTheShellOpenedGoesOn) {
  const std::string content = run(simulate + "--out -").output;
  ASSERT_FALSE(content.empty());
  for (const char* out : {"-", "/dev/stdout"}) {
    ASSERT_EQ(run("echo before >log; " + simulate + "--out " + out + " >>log; echo behind >>log").exit_code, 0);
    EXPECT_EQ(read_file(at("log")), "before\n" + content + "behind\n");
  }
  ASSERT_EQ(
      run(simulate + "--out >(cat >substituted); wait $!; while [ ! -s substituted ]; do sleep 0.01; done").exit_code,
      0);
  EXPECT_EQ(read_file(at("substituted")), content);
  ASSERT_EQ(run("exec 7>seventh; " + simulate + "--out /dev/fd/7; echo behind >&7").exit_code, 0);
  EXPECT_EQ(read_file(at("seventh")), content + "behind\n");
  expect_refused(simulate + "--out log >>log", 2, "--out log: standard output goes to that file");
  expect_refused(simulate + "--out - >&-", 1, "standard output cannot be written");
}

TEST_F(Outputs, DevicesAndPipesStay) {
  const std::string content = run(simulate + "--out -").output;
  ASSERT_EQ(run("mkfifo pipe; cat pipe >received & " + simulate + "--out pipe; wait").exit_code, 0);
  EXPECT_EQ(read_file(at("received")), content);
  EXPECT_TRUE(fs::is_fifo(at("pipe")));
  if (::mknod(at("sink").c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 ||
      ::mknod(at("full").c_str(), S_IFCHR | 0666, makedev(1, 7)) != 0)
    GTEST_SKIP() << "makes no devices";
  EXPECT_EQ(run(correct + "--out sink --json sink").exit_code, 0) << "two outputs may vanish in one device";
  const CommandResult full = run(correct + "--linear --out commands.csv --json full");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.errors, "correct: full: could not be written whole: No space left on device\n");
  for (const char* device : {"sink", "full"}) EXPECT_TRUE(fs::is_character_file(at(device))) << device;
  for (const auto& entry : fs::directory_iterator(folder_.path()))
    EXPECT_FALSE(entry.path().filename().string().starts_with("sink.")) << "no figures beside a device";
}

TEST_F(Outputs, LinksAreFollowedAndModesStay) {
  fs::create_directory(at("elsewhere"));
  fs::create_symlink("elsewhere/commands.csv", at("link"));
  write_file(at("private.json"), "{}");
  fs::permissions(at("private.json"), fs::perms(0600));
  write_file(at("link.partial"), "of the user");
  ASSERT_EQ(run(correct + "--out link --json private.json").exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(at("link")));
  EXPECT_NE(read_file(at("elsewhere/commands.csv")).find("converged"), std::string::npos);
  EXPECT_EQ(fs::status(at("private.json")).permissions(), fs::perms(0600));
  EXPECT_EQ(nlohmann::json::parse(read_file(at("private.json")))["targets"], 2);
  EXPECT_EQ(read_file(at("link.partial")), "of the user");
}

TEST_F(Outputs, ExitCodesHoldIfNobodyCanReadErrors) {
  EXPECT_EQ(run(correct + "--nonsense 2>/dev/full").exit_code, 2);
  EXPECT_EQ(run("$P/correct --model none.json --targets none.csv --out o.csv 2>/dev/full").exit_code, 1);
}

TEST_F(Outputs, TwoOutputsAreTwoFiles) {
  write_file(at("a.csv"), "old");
  fs::create_symlink("a.csv", at("b.csv"));
  fs::create_symlink("new.csv", at("c.csv"));
  expect_refused(correct + "--out - --json -", 2, "--json and --out cannot both be standard output");
  expect_refused(correct + "--out /dev/stdout --json -", 2, "cannot both be standard output");
  expect_refused(correct + "--out a.csv --json a.csv", 2, "--json and --out cannot both be a.csv");
  expect_refused(correct + "--out a.csv --json ./b.csv", 2, "--json and --out cannot both be a.csv");
  expect_refused(correct + "--out new.csv --json c.csv", 2, "--json and --out cannot both be new.csv");
  expect_refused("$P/calibrate --robot abb_irb120 --data measured.csv --save m --report m", 2,
                 "--save and --report cannot both be m");
  expect_refused("$P/calibrate --robot abb_irb120 --data measured.csv --save calibrate_out/poses.svg", 2,
                 "--save calibrate_out/poses.svg: names that end in .svg are for figures");
  const CommandResult beside = run(correct + "--out x --json x.partial");
  EXPECT_EQ(beside.exit_code, 0) << beside.errors;
  EXPECT_EQ(nlohmann::json::parse(read_file(at("x.partial")))["targets"], 2);
  EXPECT_NE(read_file(at("x")).find("converged"), std::string::npos);
}

TEST_F(Outputs, WhatCannotBeWrittenIsRefusedBeforeTheWork) {
  const std::string calibrate = "$P/calibrate --robot abb_irb120 --data measured.csv --save model2.json ";
  write_file(at("taken"), "a file");
  expect_refused(calibrate + "--report missing/page.html", 1, "missing/page.html: cannot be written: No such file");
  expect_refused(calibrate + "--json .", 1, ".: is a folder, cannot be written as a file");
  expect_refused(calibrate + "--out taken", 1, "taken: is not a folder");
  expect_refused(calibrate + "--out taken/figures", 1, "taken: is not a folder");
  fs::create_symlink("nowhere", at("dangling"));
  expect_refused(calibrate + "--out dangling", 1, "dangling: is not a folder");
  expect_refused(calibrate + "--out -", 2, "--out takes a folder, which cannot be standard output");
  expect_refused("$P/compare --methods none --poses 10 --results -", 2, "--results takes a file that grows");
  expect_refused("$P/iso9283 --data measured.csv --commanded measured.csv --out missing/p", 1,
                 "missing: is not a folder");
  expect_refused("$P/export_robot --robot abb_irb120 --data measured.csv --ur-kinematics taken/x", 1,
                 "taken/x: cannot be written: Not a directory");
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  const std::string other = "setpriv --reuid=65534 --regid=65534 --clear-groups ";
  if (run(other + "true").exit_code != 0) GTEST_SKIP() << "no setpriv";
  if (run(other + "ls $P/correct").exit_code != 0) GTEST_SKIP() << "the programs are not for everybody";
  expect_refused(other + calibrate + "--json r.json", 1, "model2.json: cannot be written: Permission denied");
  expect_refused(other + "$P/calibrate --robot abb_irb120 --data measured.csv", 1,
                 ".: this folder takes no new files: Permission denied");
}

TEST_F(Outputs, AFileThatIsMountedAloneIsWrittenInPlace) {
  write_file(at("inside"), "old");
  write_file(at("outside"), "a file of the host");
  const std::string content = run(simulate + "--out -").output;
  const CommandResult result =
      run("unshare -m bash -c 'mount --bind outside inside || exit 77; " + simulate + "--out inside' || exit $?");
  if (result.exit_code == 77 || result.errors.find("unshare") == 0) GTEST_SKIP() << result.errors;
  if (result.errors.empty()) GTEST_SKIP() << "this system does not tell what is mounted";
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors,
            "simulate_measurements: inside cannot be replaced by a whole new file; it is written in place, at the "
            "end\n");
  EXPECT_EQ(read_file(at("outside")), content);
  EXPECT_EQ(read_file(at("inside")), "old");
}

TEST_F(Outputs, AnInputMayBeTheOutputAndSurvivesAFailure) {
  const std::string expected = run(correct + "--out -").output, targets = read_file(at("targets.csv"));
  ASSERT_EQ(run(correct + "--out targets.csv").exit_code, 0);
  EXPECT_EQ(read_file(at("targets.csv")), expected);
  write_file(at("targets.csv"), targets + "0.1,nan,0,0,0,0\n");
  expect_refused(correct + "--out targets.csv", 1, "targets.csv, line 4");
}

// The figure of a path is named after the commands.
TEST_F(Outputs, AFigureDoesNotReplaceTheCommands) {
  ASSERT_EQ(run(correct + "--linear --out commands.svg").exit_code, 0);
  EXPECT_TRUE(read_file(at("commands.svg")).starts_with("q1_rad,"));
}

}  // namespace
}  // namespace vernier::outputs_test
