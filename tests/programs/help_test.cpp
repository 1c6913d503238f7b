// SPDX-License-Identifier: BSD-3-Clause
// What all programs say of themselves: help, examples, completion, and how loud and how colourful they are.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "run_command.hpp"
#include "temporary_folder.hpp"

namespace vernier::help_test {
namespace {

namespace fs = std::filesystem;
using vernier_test::CommandResult;
using vernier_test::TemporaryFolder;

/// The programs that this build has; some need a library that may be missing.
std::vector<std::string> programs() {
  std::vector<std::string> out;
  for (const char* name : {"calibrate", "compare", "correct", "describe_robot", "detect_board", "export_c",
                           "export_robot", "iso9283", "join_measurements", "make_board", "paper_comparison",
                           "plan_poses", "simulate_measurements", "verify_calibration"})
    if (fs::exists(fs::path(VERNIER_EXAMPLES_DIR) / name)) out.emplace_back(name);
  return out;
}

CommandResult run(const TemporaryFolder& folder, const std::string& command) {
  const fs::path work = folder.path() / "work";
  fs::create_directory(work);
  return vernier_test::run_command(
      "cd '" + work.string() + "' && PATH='" + VERNIER_EXAMPLES_DIR + "':$PATH && " + command, folder.path());
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}

/// The lines of a section of a help text, without those of the next one.
std::vector<std::string> section(const std::string& help, const std::string& title) {
  std::vector<std::string> out;
  bool inside = false;
  for (const std::string& line : lines_of(help)) {
    if (inside && line.empty()) break;
    if (inside) out.push_back(line);
    inside = inside || line == title + ":";
  }
  return out;
}

/// The commands under Examples; lines that go on are joined.
std::vector<std::string> examples(const std::string& help) {
  std::vector<std::string> out;
  for (const std::string& line : section(help, "Examples")) {
    if (line.starts_with("      "))
      out.back() += line.substr(5);
    else
      out.push_back(line.substr(2));
  }
  return out;
}

std::set<std::string> options(const std::string& help) {
  std::set<std::string> out;
  const std::regex option("\n  (?:-h,)?(--[a-z][a-z0-9-]*)");
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at) out.insert((*at)[1]);
  return out;
}

TEST(Help, HasPurposeGroupsExamplesAndExitCodes) {
  const TemporaryFolder folder("help");
  ASSERT_GE(programs().size(), 10u);
  for (const std::string& name : programs()) {
    const CommandResult help = run(folder, name + " --help");
    ASSERT_EQ(help.exit_code, 0) << name;
    EXPECT_EQ(help.errors, "") << name;
    const std::vector<std::string> lines = lines_of(help.output);
    const std::string purpose = help.output.substr(0, help.output.find("\n\n"));
    EXPECT_EQ(purpose.find(". "), std::string::npos) << name << ": one sentence";
    EXPECT_TRUE(purpose.ends_with(".") && purpose.size() < 200) << purpose;
    EXPECT_NE(help.output.find("\n\nusage: " + name), std::string::npos) << help.output;
    std::size_t last = 0;
    for (const char* group : {"Input", "Output", "General", "Examples", "Exit codes"}) {
      const std::size_t at = help.output.find(std::string("\n") + group + ":\n");
      ASSERT_NE(at, std::string::npos) << name << " has no " << group;
      EXPECT_GT(at, last) << name << ": " << group;
      last = at;
    }
    EXPECT_EQ(section(help.output, "Exit codes").size(), 3u) << help.output;
    for (const std::string& line : lines) EXPECT_LE(line.size(), 100u) << name << ": " << line;
    EXPECT_NE(lines.front().find_first_not_of(' '), std::string::npos);
  }
}

TEST(Help, MarksWhatIsRequired) {
  const TemporaryFolder folder("required");
  for (const std::string& name : programs()) {
    const std::string help = run(folder, name + " --help").output;
    const std::size_t usage = help.find("usage: ");
    const bool requires_something =
        help.substr(usage, help.find("\n\n", usage) - usage).find(" --") != std::string::npos;
    EXPECT_EQ(requires_something, help.find("REQUIRED: ") != std::string::npos) << help;
    if (!requires_something) continue;
    const CommandResult without = run(folder, name);
    EXPECT_EQ(without.exit_code, 2) << name;
    EXPECT_TRUE(without.one_line_of_errors()) << without.errors;
    const std::string missing = without.errors.substr(without.errors.find("--"),
                                                      without.errors.find(" is required") - without.errors.find("--"));
    EXPECT_NE(help.substr(usage, help.find("\n\n", usage) - usage).find(missing), std::string::npos)
        << missing << " is required, and not marked\n"
        << help;
  }
}

/// An example whose files are missing is not done, but it is no wrong usage either.
TEST(Help, ExamplesAreCommandsThatTheProgramsTake) {
  for (const std::string& name : programs()) {
    const TemporaryFolder folder("examples");
    const std::string help = run(folder, name + " --help").output;
    const std::vector<std::string> commands = examples(help);
    EXPECT_EQ(commands.size(), 2u) << help;
    for (const std::string& command : commands) {
      EXPECT_TRUE(command.starts_with(name + " ")) << command;
      const CommandResult done = run(folder, "timeout 3 " + command);
      EXPECT_NE(done.exit_code, 2) << command << "\n" << done.errors;
      if (done.exit_code != 0 && done.exit_code != 124) {
        EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
      }
    }
  }
}

TEST(Completion, OffersOptionsAndTheirWords) {
  const TemporaryFolder folder("completion");
  for (const std::string& name : programs()) {
    const std::string source = "bash -c 'source <(" + name + " --completion); ",
                      offers = "printf \"%s\\n\" \"${COMPREPLY[@]}\"'";
    const auto complete = [&](const std::string& words, int at) {
      const CommandResult done =
          run(folder, source + "COMP_WORDS=(" + name + " " + words + "); COMP_CWORD=" + std::to_string(at) +
                          "; _vernier_" + name + "; " + offers);
      EXPECT_EQ(done.errors, "") << name;
      const std::vector<std::string> found = lines_of(done.output);
      return std::set<std::string>(found.begin(), found.end());
    };
    EXPECT_EQ(complete("--", 1), options(run(folder, name + " --help").output)) << name;
    EXPECT_EQ(complete("--completi", 1), std::set<std::string>{"--completion"}) << name;
    EXPECT_EQ(complete("--seed 1", 2), std::set<std::string>{""}) << name;
    if (name == "calibrate") {
      EXPECT_EQ(complete("--loss ''", 2), (std::set<std::string>{"cauchy", "huber", "squared"}));
      EXPECT_EQ(complete("--robot ur", 2), (std::set<std::string>{"ur10", "ur5"}));
    }
  }
}

TEST(Console, QuietProgramsPrintNothing) {
  const TemporaryFolder folder("quiet");
  const std::string command = "make_board --rows 6 --columns 9 --square-mm 20 --svg - --board b.json";
  const CommandResult loud = run(folder, command), quiet = run(folder, command + " --quiet");
  EXPECT_EQ(loud.exit_code, 0);
  EXPECT_NE(loud.errors, "") << "what is for people makes room for the result";
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.errors, "");
  EXPECT_EQ(quiet.output, loud.output);
  const CommandResult described = run(folder, "describe_robot --robot ur10 --out a --quiet --json -");
  EXPECT_TRUE(described.output.starts_with("{")) << described.output;
  const CommandResult wrong = run(folder, "describe_robot --robot none --quiet");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_TRUE(wrong.one_line_of_errors());
}

TEST(Console, ColoursAreForTerminalsThatWantThem) {
  const TemporaryFolder folder("colours");
  if (std::system("script --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no program makes a terminal";
  const auto on_terminal = [&](const std::string& environment) {
    return run(folder, environment + " script -qec 'calibrate --nonsense' /dev/null").output;
  };
  EXPECT_NE(on_terminal("NO_COLOR= TERM=xterm").find("\x1b[1;31mcalibrate\x1b[0m: "), std::string::npos);
  for (const char* plain : {"NO_COLOR=1 TERM=xterm", "NO_COLOR= TERM=dumb"}) {
    const std::string said = on_terminal(plain);
    EXPECT_TRUE(said.starts_with("calibrate: ")) << said;
    EXPECT_EQ(said.find('\x1b'), std::string::npos) << plain;
  }
  EXPECT_TRUE(run(folder, "NO_COLOR= TERM=xterm calibrate --nonsense").errors.starts_with("calibrate: "));
}

/// The letters of a figure have one size, and axes say what they count in.
TEST(Figures, HaveOneSizeOfLettersAndUnits) {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "the figures need gnuplot";
  const TemporaryFolder folder("figures");
  ASSERT_EQ(run(folder, "describe_robot --robot ur5 --out arm").exit_code, 0);
  ASSERT_EQ(run(folder, "plan_poses --robot ur5 --count 10 --candidates 100 --out plan.csv").exit_code, 0);
  int figures = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
    if (entry.path().extension() != ".svg") continue;
    ++figures;
    const std::string svg = read_file(entry.path());
    std::set<std::string> sizes;
    const std::regex size("font-size=\"([0-9.]+)\"");
    for (std::sregex_iterator at(svg.begin(), svg.end(), size), end; at != end; ++at) sizes.insert((*at)[1]);
    EXPECT_EQ(sizes.size(), 1u) << entry.path();
    EXPECT_NE(svg.find(" ["), std::string::npos) << entry.path() << " has no unit";
  }
  EXPECT_EQ(figures, 5);
}

}  // namespace
}  // namespace vernier::help_test
