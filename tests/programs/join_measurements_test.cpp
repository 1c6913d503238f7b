// SPDX-License-Identifier: BSD-3-Clause
// Runs join_measurements on tables that are made here, by order and by name, and with each damage.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "real_matrix.hpp"
#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/kinematics/framed.hpp"
#include "vernier/kinematics/robots.hpp"
#include "vernier/simulation/sampling.hpp"
#include "vernier/simulation/virtual_robot.hpp"

namespace vernier::join_measurements_test {
namespace {

using vernier_test::CommandResult;

class JoinMeasurements : public ::testing::Test {
 protected:
  JoinMeasurements() {
    const auto robot = robots::ur10();
    joints_ = sample_joints(robot.limits, 40, 3);
    Isometry3 base = Isometry3::Identity(), tool = base;
    base.linear() = exp_so3(Vector3(0.3, -0.5, 1));
    base.translation() = Vector3(2, -1, 0.5);
    tool.translation() = Vector3(0.03, 0.05, 0.12);
    points_ = measure(Framed<DhChain<6>>(with_geometric_errors(robot.chain, {}, 4), base, tool), joints_,
                      {.position = 3e-5, .with_orientations = false}, 5)
                  .positions();
    std::string text = "target,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,temperature_c\n";
    for (Index i = 0; i < 40; ++i) {
      text += message('P', i, ',');
      for (int j = 0; j < 6; ++j) text += message(joints_(i, j), ',');
      text += message(20 + i, '\n');
    }
    write_file(folder_ / "commanded.csv", text);
  }

  /// A table as SpatialAnalyzer exports it, with the points of these rows.
  void write_table(const std::vector<Index>& rows, double unit = 1e-3) {
    std::string text = "// SpatialAnalyzer\n";
    for (const Index i : rows) {
      text += message("A Main P", i);
      for (int k = 0; k < 3; ++k) text += message(' ', points_(i, k) / unit);
      text += '\n';
    }
    write_file(folder_ / "tracker.txt", text);
  }
  static std::vector<Index> all() {
    std::vector<Index> out(40);
    for (Index i = 0; i < 40; ++i) out[static_cast<std::size_t>(i)] = i;
    return out;
  }

  CommandResult join(const std::string& arguments) {
    return vernier_test::run_command("cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR +
                                         "/join_measurements' --joints commanded.csv " + arguments,
                                     folder_.path());
  }
  void expect_refused(const std::string& arguments, int exit_code, const std::string& words) {
    const CommandResult done = join(arguments);
    EXPECT_EQ(done.exit_code, exit_code) << arguments << "\n" << done.errors;
    EXPECT_TRUE(done.one_line_of_errors()) << arguments << "\n" << done.errors;
    EXPECT_NE(done.errors.find(words), std::string::npos) << arguments << "\n" << done.errors;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "measured.csv")) << arguments;
  }

  vernier_test::TemporaryFolder folder_{"join_measurements"};
  JointRows<6> joints_;
  PointRows points_;
};

const std::string by_order = "--points tracker.txt --preset sa --unit mm --robot ur10 --out measured.csv ";

TEST_F(JoinMeasurements, ByOrder) {
  write_table(all());
  const CommandResult done = join(by_order + "--json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("40 pairs of 40 rows and 40 points, by order"), std::string::npos) << done.output;
  const auto data = read_dataset<6>(folder_ / "measured.csv");
  EXPECT_EQ(data.joints(), joints_);
  EXPECT_LT(vernier_test::difference(data.positions(), points_), 1e-14);
  EXPECT_EQ(data.temperatures()(39), 59);
  const CsvText text = read_csv_text(folder_ / "measured.csv");
  EXPECT_EQ(text.header.back(), "points_line");
  EXPECT_EQ(text.rows[0][text.header.size() - 2], "2");
  EXPECT_EQ(text.rows[39].back(), "41");
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json"));
  EXPECT_EQ(result.at("pairs"), 40);
  EXPECT_TRUE(result.at("faults").empty());
  EXPECT_NEAR(result.at("proof").at("scale"), 1, 0.02);
  EXPECT_NEAR(result.at("proof").at("offset_mm").at(2), 120, 10);
}

TEST_F(JoinMeasurements, FaultsAreNamedAndLeftOut) {
  std::vector<Index> rows = all();
  std::swap(rows[30], rows[31]);
  rows.insert(rows.begin() + 21, 20);
  rows.erase(rows.begin() + 7);
  write_table(rows);
  expect_refused(by_order, 1, "tracker.txt: 3 departures from commanded.csv, listed above; with --leave-out");
  const CommandResult done = join(by_order + "--leave-out --json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  for (const std::string words :
       {"commanded.csv, line 9: no point in tracker.txt, expected between lines 8 and 9",
        "tracker.txt, 1 of lines 21 to 22: no pose in commanded.csv",
        "tracker.txt, lines 32 and 33: swapped; line 33 belongs to line 32 of commanded.csv, line 32 to line 33",
        "39 pairs of 40 rows and 40 points, by order"})
    EXPECT_NE(done.output.find(words), std::string::npos) << words << "\n" << done.output;
  const auto data = read_dataset<6>(folder_ / "measured.csv");
  ASSERT_EQ(data.size(), 39);
  for (Index i = 0; i < 39; ++i) {
    const Index row = i < 7 ? i : i + 1;
    EXPECT_EQ(data.joints(i), joints_.row(row).transpose());
    EXPECT_LT((data.position(i) - points_.row(row).transpose()).norm(), 1e-14);
    EXPECT_EQ(data.times()(i), static_cast<double>(row));
    EXPECT_EQ(data.previous().row(i), joints_.row(std::max<Index>(row, 1) - 1));
  }
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json"));
  ASSERT_EQ(result.at("faults").size(), 3u);
  EXPECT_EQ(result.at("faults").at(0).at("kind"), "missing");
}

TEST_F(JoinMeasurements, ByName) {
  std::vector<Index> rows = all();
  std::reverse(rows.begin(), rows.end());
  write_table(rows);
  const std::string by_name = "--points tracker.txt --preset sa --unit mm --key target --out measured.csv ";
  CommandResult done = join(by_name);
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("Neither unit nor frame are checked without --robot"), std::string::npos);
  EXPECT_LT(vernier_test::difference(read_dataset<6>(folder_ / "measured.csv").positions(), points_), 1e-14);
  done = join(by_name + "--robot ur10");
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  std::filesystem::remove(folder_ / "measured.csv");
  rows.push_back(3);
  write_table(rows);
  expect_refused(by_name, 1, "tracker.txt, line 42, column name: 'P3' is in line 38 already");
  rows.pop_back();
  rows.erase(rows.begin());
  write_table(rows);
  expect_refused(by_name, 1, "tracker.txt: 1 departures from commanded.csv");
  expect_refused("--points tracker.txt --preset sa --unit mm --key name --out measured.csv", 1,
                 "commanded.csv: no column name in the header");
  write_file(folder_ / "tracker.txt", "// none\n");
  expect_refused(by_name, 1, "tracker.txt: no points");
}

TEST_F(JoinMeasurements, DecimalComma) {
  std::string text = "Nr;X;Y;Z\n";
  for (Index i = 0; i < 40; ++i) {
    text += message(i);
    for (int k = 0; k < 3; ++k) {
      std::string number = message(points_(i, k));
      std::replace(number.begin(), number.end(), '.', ',');
      text += ';' + number;
    }
    text += '\n';
  }
  write_file(folder_ / "tracker.txt", text);
  const CommandResult done = join(
      "--points tracker.txt --columns number,x,y,z --separator ';' --decimal , --header-lines 1 --unit m --robot ur10 "
      "--out measured.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_LT(vernier_test::difference(read_dataset<6>(folder_ / "measured.csv").positions(), points_), 1e-14);
}

TEST_F(JoinMeasurements, RefusesWhatCannotBe) {
  write_table(all(), 0.0254);
  expect_refused(by_order, 1, "tracker.txt: the points would fit the arm if their coordinates were 25.");
  points_.col(2) *= -1;
  write_table(all());
  expect_refused(by_order, 1, "their frame is left-handed; exchange two of x, y, z");
  expect_refused("--points tracker.txt --preset sa --unit mm --robot ur5 --out measured.csv", 1, "tracker.txt: ");
  expect_refused("--points tracker.txt --unit mm --robot ur10 --out measured.csv", 2, "is not guessed");
  expect_refused("--points tracker.txt --columns name,x,y,z --unit mm --robot ur10 --out measured.csv", 2,
                 "is not guessed");
  expect_refused("--points tracker.txt --columns x,y --separator , --unit mm --robot ur10 --out measured.csv", 2,
                 "no column z");
  expect_refused("--points tracker.txt --preset sa --separator ab --unit mm --robot ur10 --out measured.csv", 2,
                 "--separator takes one character");
  expect_refused("--points tracker.txt --preset sa --unit ell --robot ur10 --out measured.csv", 2, "--unit");
  expect_refused("--points tracker.txt --preset sa --robot ur10 --out measured.csv", 2, "--unit is required");
  expect_refused("--points tracker.txt --preset sa --unit mm --out measured.csv", 2, "--robot is needed to prove");
  expect_refused("--points tracker.txt --preset sa --unit mm --robot ur10", 2, "--out is required");
  expect_refused(by_order + "--separator ,", 1,
                 "tracker.txt, line 2: 1 cell, 6 columns are declared, separated by ','");
  write_file(folder_ / "commanded.csv", "q1_rad\n1\n");
  expect_refused(by_order, 1, "commanded.csv, line 1: no column q2_rad");
  write_file(folder_ / "commanded.csv", "target,q1_rad,x_mm\nP1,1,2\n");
  expect_refused("--points tracker.txt --preset sa --unit mm --key target --out measured.csv", 1,
                 "commanded.csv: has a column x_mm already");
}

}  // namespace
}  // namespace vernier::join_measurements_test
