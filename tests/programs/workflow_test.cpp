// SPDX-License-Identifier: BSD-3-Clause
// From the table of an arm to a plan, a measurement, a report and corrected commands: the five commands of the guide.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::workflow_test {
namespace {

TEST(Workflow, FromATableToAReportInFiveCommands) {
  const vernier_test::TemporaryFolder folder("workflow");
  const auto run = [&](const std::string& command) {
    const auto done = vernier_test::run_command(
        "cd '" + folder.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/" + command, folder.path());
    EXPECT_EQ(done.exit_code, 0) << command << ": " << done.errors;
    return done.output;
  };
  const Robot<6> arm = robots::abb_irb120();
  nlohmann::json table{{"name", "my arm"}, {"convention", "standard"}, {"joints", nlohmann::json::array()}};
  for (int i = 0; i < 6; ++i)
    table["joints"].push_back({{"a_mm", arm.chain.row(i).a * 1e3},
                               {"alpha_deg", arm.chain.row(i).alpha * 180 / std::numbers::pi},
                               {"d_mm", arm.chain.row(i).d * 1e3},
                               {"theta_deg", arm.chain.row(i).theta * 180 / std::numbers::pi},
                               {"lower_deg", arm.limits.lower(i) * 180 / std::numbers::pi},
                               {"upper_deg", arm.limits.upper(i) * 180 / std::numbers::pi}});
  write_file(folder / "my_arm.json", table.dump());
  write_file(folder / "targets.csv",
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n0,20,10,0,60,0\n10,25,5,0,60,10\n-30,0,-20,40,-50,0\n");

  run("plan_poses' --robot my_arm.json --count 60 --candidates 500 --orientations --out poses.csv");
  run("simulate_measurements' --robot my_arm.json --poses poses.csv --out measured.csv");
  const std::string calibrated =
      run("calibrate' --robot my_arm.json --data measured.csv --test-every 5 --save model.json --report report.html "
          "--json report.json --out figures");
  run("correct' --model model.json --targets targets.csv --out commands.csv");
  run("plan_poses' --robot my_arm.json --data measured.csv --add 5 --candidates 300 --out more.csv");

  EXPECT_NE(calibrated.find("Report: report.html"), std::string::npos);
  EXPECT_EQ(read_file(folder / "report.html").rfind("<!DOCTYPE html>", 0), 0u);
  const auto report = nlohmann::json::parse(read_file(folder / "report.json"));
  EXPECT_TRUE(report.contains("audit"));
  const auto planned = read_joints<6>(folder / "poses.csv"), targets = read_joints<6>(folder / "targets.csv"),
             commands = read_joints<6>(folder / "commands.csv"), more = read_joints<6>(folder / "more.csv");
  EXPECT_GE(planned.rows(), 60);
  ASSERT_EQ(commands.rows(), targets.rows());
  EXPECT_GE(more.rows(), 5);
  // a corrected command is another one, nearby, and takes the model where the nominal arm was to be
  const auto robot = load<6>(folder / "model.json");
  for (Index i = 0; i < targets.rows(); ++i) {
    const JointVector<6> target = targets.row(i).transpose(), command = commands.row(i).transpose();
    EXPECT_GT((command - target).norm(), 1e-6);
    EXPECT_LT((command - target).norm(), 0.2);
    EXPECT_LT((robot.position(command) - robot.nominal().position(target)).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace vernier::workflow_test
