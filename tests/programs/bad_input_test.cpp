// SPDX-License-Identifier: BSD-3-Clause
// Malformed files and wrong usage, given to the programs: one clear line, the exit code, and not one file more.

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "replaced.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/io.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::bad_input_test {
namespace {

using vernier_test::CommandResult;
using vernier_test::replaced;
using vernier_test::TemporaryFolder;

CalibratedRobot<6> model() {
  const auto robot = robots::abb_irb120();
  using Model = CalibratedRobot<6>::Model;
  return {"an arm", Model(robot.chain, Model::Arm(with_geometric_errors(robot.chain, {}, 3))), robot.limits, {}};
}

class BadInputToPrograms : public ::testing::Test {
 protected:
  BadInputToPrograms() {
    const auto robot = robots::abb_irb120();
    const Framed<DhChain<6>> actual(with_geometric_errors(robot.chain, {}, 4));
    const JointRows<6> joints = abb_irb120_operating_region().sample(robot.chain, 60, 3);
    const auto data = measure(actual, joints, {.position = 3e-5, .with_orientations = false}, 4);
    write_dataset(folder_ / "poses.csv", data);
    text_ = read_file(folder_ / "poses.csv");
    save(folder_ / "model.json", model());
  }

  std::vector<std::string> files() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      out.push_back(entry.path().string());
    std::sort(out.begin(), out.end());
    return out;
  }

  /// Runs a program that must refuse: the exit code, one line on standard error with some words in it, and not one file
  /// more than before.
  void expect_refused(const std::string& arguments, int exit_code, const std::string& words) {
    const auto before = files();
    const TemporaryFolder streams("bad_input_streams");
    const CommandResult result = vernier_test::run_command(
        "cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "'/" + arguments, streams.path());
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.errors;
    EXPECT_TRUE(result.one_line_of_errors()) << arguments << "\n" << result.errors;
    EXPECT_NE(result.errors.find(words), std::string::npos) << arguments << "\n" << result.errors;
    EXPECT_EQ(files(), before) << arguments;
  }

  TemporaryFolder folder_{"bad_input"};
  std::string text_;  // of poses.csv
};

const std::string calibrate = "calibrate --robot abb_irb120 --save m.json --json r.json --out figures ";

TEST_F(BadInputToPrograms, CompareFiles) {
  const std::string compare = "compare --methods none,elm --seeds 1,2 --json r.json --data ";
  expect_refused(compare + "missing.csv --poses 0", 1, "compare: missing.csv: No such file or directory");
  write_file(folder_ / "nan.csv", text_ + "nan,0,0,0,0,0,1,2,3\n");
  expect_refused(compare + "nan.csv --poses 0", 1, "nan.csv, line 62, column q1_rad: 'nan' is not finite");
  expect_refused(compare + "poses.csv --poses 20,49", 2,
                 "poses.csv: 49 poses are asked for, there are 48 to learn from");
}

TEST_F(BadInputToPrograms, CalibrateFiles) {
  expect_refused(calibrate + "--data missing.csv", 1, "calibrate: missing.csv: No such file or directory");
  expect_refused(calibrate + "--data .", 1, "is a folder, not a file");
  write_file(folder_ / "empty.csv", "");
  expect_refused(calibrate + "--data empty.csv", 1, "empty.csv: empty");
  write_file(folder_ / "binary.csv", std::string("\x00\x01\xFF\n\x02", 5));
  expect_refused(calibrate + "--data binary.csv", 1, "binary.csv, line 1: binary data");
  write_file(folder_ / "cut.csv", text_.substr(0, text_.rfind(',')));
  expect_refused(calibrate + "--data cut.csv", 1, "cut.csv, line 61: 8 values, the header has 9");
  write_file(folder_ / "nan.csv", text_ + "nan,0,0,0,0,0,1,2,3\n");
  expect_refused(calibrate + "--data nan.csv", 1, "nan.csv, line 62, column q1_rad: 'nan' is not finite");
  expect_refused(calibrate + "--data poses.csv --test empty.csv", 1, "empty.csv: empty");
  write_file(folder_ / "robot.json", "{\"name\": \"x\", \"convention\": \"standard\", \"joints\": [1, 2, 3]}");
  expect_refused("calibrate --robot robot.json --data poses.csv --out figures", 1,
                 "robot.json: joints[0]: must be an object, is a whole number");
  expect_refused("calibrate --robot barrett_wam --data poses.csv --out figures", 1, "no column q7_rad");
}

TEST_F(BadInputToPrograms, CalibrateDataThatCannotBeRight) {
  // the same numbers under other units
  const double degree = std::numbers::pi / 180;
  const auto data = read_dataset<6>(folder_ / "poses.csv");
  write_dataset(folder_ / "degrees.csv", Dataset<6>(data.joints() / degree, data.positions()));
  expect_refused(calibrate + "--data degrees.csv", 1, "looks like degrees in a _rad column");
  write_file(folder_ / "radians.csv",
             replaced(replaced(replaced(replaced(replaced(replaced(text_, "q1_rad", "q1_deg"), "q2_rad", "q2_deg"),
                                                 "q3_rad", "q3_deg"),
                                        "q4_rad", "q4_deg"),
                               "q5_rad", "q5_deg"),
                      "q6_rad", "q6_deg"));
  expect_refused(calibrate + "--data radians.csv", 1, "radians in a _deg column?");
  write_dataset(folder_ / "metres.csv", Dataset<6>(data.joints(), data.positions() / 1000));
  expect_refused(calibrate + "--data metres.csv", 1, "x, y, z in m called _mm?");
  write_dataset(folder_ / "millimetres.csv", Dataset<6>(data.joints(), data.positions() * 1000));
  expect_refused(calibrate + "--data millimetres.csv", 1, "x, y, z in mm called _m?");
  expect_refused("calibrate --robot ur10 --data poses.csv --out figures", 1, "wrong robot, units or columns?");
  JointRows<6> swapped = data.joints();
  swapped.col(1).swap(swapped.col(2));
  write_dataset(folder_ / "swapped.csv", Dataset<6>(swapped, data.positions()));
  expect_refused(calibrate + "--data swapped.csv", 1, "wrong robot, units or columns?");
  const std::vector<Index> few{0, 1, 2, 3, 4, 5, 6, 7};
  write_dataset(folder_ / "few.csv", data.rows(few));
  expect_refused(calibrate + "--data few.csv", 1, "underdetermined");
  write_dataset(folder_ / "one.csv", data.rows(std::span(few).first(1)));
  expect_refused(calibrate + "--data one.csv", 1, "a single row");
  JointRows<6> still = data.joints();
  still.rowwise() = still.row(0).eval();
  write_dataset(folder_ / "still.csv", Dataset<6>(still, data.positions().row(0).replicate(60, 1)));
  expect_refused(calibrate + "--data still.csv", 1, "still.csv: split: the 60 rows visit too few poses");
}

TEST_F(BadInputToPrograms, WrongUsage) {
  expect_refused("calibrate --data poses.csv", 2, "--robot is required");
  expect_refused("calibrate --robot nobody --data poses.csv", 2, "no robot is called 'nobody'; there are abb_irb120");
  expect_refused(calibrate + "--data poses.csv --test-every 1", 2, "--test-every");
  expect_refused(calibrate + "--data poses.csv --test-every 5 --test-fraction 0.2", 2, "excludes");
  expect_refused(calibrate + "--data poses.csv --loss best", 2, "--loss");
  expect_refused(calibrate + "--data poses.csv --date '2024\n05'", 2, "--date takes up to 40 plain characters");
  expect_refused(calibrate + "--data poses.csv --no-such-option", 2, "--no-such-option");
  expect_refused(calibrate + "--data poses.csv --fix d9", 1, "no parameter is called 'd9'");
  expect_refused("calibrate --robot abb_irb120 --data poses.csv --save missing/m.json", 1,
                 "missing/m.json: cannot be written");
  expect_refused("correct --model model.json --targets poses.csv", 2, "--out is required");
  expect_refused(calibrate + "--data poses.csv --split sideways", 2, "--split");
  expect_refused(calibrate + "--data poses.csv --split time --test-every 5", 2, "excludes");
  expect_refused(calibrate + "--data poses.csv --train 0", 2, "--train");
  expect_refused(calibrate + "--data poses.csv --train 49", 1, "--train asks for 49 rows, there are 48 to learn from");
  expect_refused(calibrate + "--data poses.csv poses.csv --test poses.csv", 2, "1 files of --test for 2 of --data");
  expect_refused(calibrate + "--data poses.csv --harmonics -1", 2, "--harmonics");
  expect_refused("calibrate --model model.json --data poses.csv", 2, "--free");
  expect_refused("calibrate --model model.json --data poses.csv --free elbow", 2, "not 'elbow'");
  expect_refused("calibrate --robot ur10 --model model.json --data poses.csv --free base", 2, "excludes");
  expect_refused(calibrate + "--data poses.csv --prior missing.json", 1, "missing.json");
  expect_refused(calibrate + "--data poses.csv --prior model.json", 2, "model.json: has no covariance");
  expect_refused("calibrate --robot barrett_wam --data poses.csv --prior model.json", 2,
                 "model.json: is of an arm of 6 joints, expected 7");
}

TEST_F(BadInputToPrograms, NumbersOutOfRange) {
  const std::string plan = "plan_poses --robot ur10 --out p.csv --count ",
                    path = "correct --model model.json --out c.csv ";
  expect_refused(plan + "2", 2, "--count: Value 2 not in range 3 to 100000 (see --help)");
  expect_refused(plan + "3.5", 2, "--count: Value 3.5 not in range 3 to 100000");
  expect_refused(plan + "5 --acceptance-deg nan", 2, "--acceptance-deg: Value nan not in range 1 to 180");
  for (const std::string value : {"0", "-1", "nan", "inf"})
    expect_refused(path + "--tolerance-mm " + value, 2, "Value " + value + " is not a positive number");
  for (const std::string option : {"--noise-mm ", "--gears-urad "})
    for (const std::string value : {"-0.1", "nan", "inf"})
      expect_refused("simulate_measurements --robot ur10 --poses p.csv --out m.csv " + option + value, 2,
                     "Value " + value + " is not a number of at least 0");
}

TEST_F(BadInputToPrograms, Reregistration) {
  const std::string again = "calibrate --model model.json --save m.json --json r.json --free ";
  expect_refused(again + "base --data missing.csv", 1, "missing.csv: No such file or directory");
  const auto data = read_dataset<6>(folder_ / "poses.csv");
  const std::vector<Index> one{0};
  write_dataset(folder_ / "one.csv", data.rows(one));
  expect_refused(again + "base --data one.csv", 1, "1 poses do not determine what may move");
  PointRows mirrored = data.positions();
  mirrored.col(0) *= -1;
  write_dataset(folder_ / "mirrored.csv", Dataset<6>(data.joints(), mirrored));
  expect_refused(again + "base --data mirrored.csv", 1, "wrong robot, units or columns?");
}

TEST_F(BadInputToPrograms, Correct) {
  expect_refused("correct --model missing.json --targets poses.csv --out c.csv", 1,
                 "correct: missing.json: No such file or directory");
  expect_refused("correct --model poses.csv --targets poses.csv --out c.csv", 1,
                 "poses.csv, line 1, column 1: not valid JSON");
  const std::string text = read_file(folder_ / "model.json");
  write_file(folder_ / "cut.json", text.substr(0, text.size() / 2));
  expect_refused("correct --model cut.json --targets poses.csv --out c.csv", 1, "the file ends here");
  write_file(folder_ / "new.json", replaced(text, "\"schema_version\": 5", "\"schema_version\": 7"));
  expect_refused("correct --model new.json --targets poses.csv --out c.csv", 1, "version 7 is unknown");
  write_file(folder_ / "targets.csv", "q1_rad,q2_rad\n0,0\n");
  expect_refused("correct --model model.json --targets targets.csv --out c.csv", 1,
                 "targets.csv, line 1: no column q3_rad");
  write_file(folder_ / "lengths.csv", "q1_mm,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n0,0,0,0,0,0\n");
  expect_refused("correct --model model.json --targets lengths.csv --out c.csv", 1,
                 "column q1_mm, but joint 1 is revolute: an angle is needed");
  expect_refused("correct --model model.json --targets poses.csv --out missing/c.csv", 1,
                 "missing/c.csv: cannot be written");
}

}  // namespace
}  // namespace vernier::bad_input_test
