// SPDX-License-Identifier: BSD-3-Clause
// Runs iso9283 on a test that is made here, and compares with the library; and plans one.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "run_command.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/evaluation/iso9283.hpp"
#include "vernier/evaluation/iso9283_path.hpp"
#include "vernier/evaluation/iso9283_poses.hpp"

namespace vernier::iso9283_program_test {
namespace {

using vernier_test::CommandResult;

class Iso9283Program : public ::testing::Test {
 protected:
  CommandResult iso(const std::string& arguments) {
    return vernier_test::run_command(
        "cd '" + folder_.path().string() + "'; '" + VERNIER_EXAMPLES_DIR + "/iso9283' " + arguments, folder_.path());
  }

  /// x_mm .. rz_rad of a pose.
  static std::string cells(const Isometry3& pose) {
    const Vector3 p = 1e3 * pose.translation(), r = log_so3(Matrix3(pose.linear()));
    return message(p.x(), ',', p.y(), ',', p.z(), ',', r.x(), ',', r.y(), ',', r.z(), '\n');
  }

  /// The poses of a plan, and visits of them.
  void write_visits(int cycles) {
    const auto poses = iso9283_poses({{0.6, 0, 0.5}, 0.4}, exp_so3(Vector3(0, 3, 0)));
    Rng rng(1);
    std::string commanded = "pose,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n", visits = "time_s,cycle," + commanded;
    for (int k = 1; k <= 5; ++k) commanded += message(k, ',') + cells(poses[static_cast<std::size_t>(k - 1)]);
    for (int cycle = 1; cycle <= cycles; ++cycle)
      for (int k = 5; k >= 1; --k) {
        Isometry3 measured = poses[static_cast<std::size_t>(k - 1)];
        measured.translation() += 1e-5 * Vector3(rng.normal() + k, rng.normal(), rng.normal());
        visits += message(20 * cycle - 4 * k, ',', cycle, ',', k, ',') + cells(measured);
      }
    write_file(folder_ / "poses.csv", commanded);
    write_file(folder_ / "visits.csv", visits);
  }

  vernier_test::TemporaryFolder folder_{"iso9283"};
};

TEST_F(Iso9283Program, Poses) {
  write_visits(30);
  const CommandResult done = iso("--data visits.csv --commanded poses.csv --json r.json --out figure");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("P2 to P4: AD "), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("Poses: as ISO 9283 asks for"), std::string::npos) << done.output;
  const auto commanded = read_labelled_poses(folder_ / "poses.csv", {"pose"});
  const auto file = read_labelled_poses(folder_ / "visits.csv", {"pose", "cycle"});
  std::vector<Iso9283Visit> visits;
  for (Index i = 0; i < 150; ++i)
    visits.push_back({file.labels(i, 0), file.labels(i, 1), 0, file.poses[static_cast<std::size_t>(i)], file.times(i)});
  const Iso9283 expected = iso9283(visits, commanded.poses);
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json")).at("iso9283");
  for (std::size_t k = 0; k < 5; ++k) {
    const auto& pose = result.at("poses").at(k);
    EXPECT_EQ(pose.at("pose"), k + 1);
    EXPECT_EQ(pose.at("visits"), 30);
    EXPECT_DOUBLE_EQ(pose.at("ap_mm"), 1e3 * expected.poses[k].ap);
    EXPECT_DOUBLE_EQ(pose.at("ap_registered_mm"), 1e3 * expected.poses[k].ap_registered);
    EXPECT_DOUBLE_EQ(pose.at("rp_mm"), 1e3 * expected.poses[k].rp);
    EXPECT_NEAR(pose.at("rp_interval_95_mm").at(1), 1e3 * expected.poses[k].rp_high, 1e-9);
    EXPECT_EQ(std::filesystem::exists(folder_ / message("figure_p", k + 1, ".svg")), done.errors.empty());
  }
  EXPECT_DOUBLE_EQ(result.at("distance").at("ad_mm"), 1e3 * expected.distance->ad);
  EXPECT_EQ(result.at("drift").size(), 5u);
  EXPECT_EQ(result.at("registration_m_rad").size(), 6u);
  EXPECT_TRUE(result.at("departures").empty());
}

TEST_F(Iso9283Program, WhatDepartsFromTheNormIsTold) {
  write_visits(1);
  const CommandResult done = iso("--data visits.csv --commanded poses.csv --json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("Poses, not as in ISO 9283: poses 1, 2, 3, 4, 5: one visit only: AP is the error of that"),
            std::string::npos)
      << done.output;
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json")).at("iso9283");
  EXPECT_TRUE(result.at("poses").at(0).at("rp_mm").is_null());
  EXPECT_EQ(result.at("departures").size(), 1u);
}

TEST_F(Iso9283Program, PathAndPositionsAlone) {
  write_file(folder_ / "path.csv", "x_mm,y_mm,z_mm\n500,-100,500\n500,100,500\n");
  std::string runs = "cycle,x_mm,y_mm,z_mm\n";
  for (int cycle = 1; cycle <= 10; ++cycle)
    for (int k = 0; k <= 100; ++k) runs += message(cycle, ',', cycle <= 5 ? 500.1 : 500.3, ',', -100 + 2 * k, ",500\n");
  write_file(folder_ / "runs.csv", runs);
  const CommandResult done = iso("--path path.csv --runs runs.csv --json r.json");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_NE(done.output.find("Path of 200.0 mm: AT 0.2000 mm, RT 0.1000 mm, 10 runs"), std::string::npos)
      << done.output;
  const auto result = nlohmann::json::parse(read_file(folder_ / "r.json")).at("path");
  EXPECT_NEAR(result.at("at_mm"), 0.2, 1e-9);
  EXPECT_NEAR(result.at("rt_mm"), 0.1, 1e-9);
  EXPECT_EQ(result.at("points").size(), 10u);
  EXPECT_TRUE(result.at("at_abc_mrad").at(0).is_null());
  EXPECT_EQ(result.at("departures").size(), 1u);
}

TEST_F(Iso9283Program, Plan) {
  const CommandResult done =
      iso("--plan --centre-mm 600,0,500 --edge-mm 400 --plane 2 --rotation-rad 0,3,0 --out poses.csv");
  ASSERT_EQ(done.exit_code, 0) << done.errors;
  const auto file = read_labelled_poses(folder_ / "poses.csv", {"pose"});
  const auto expected = iso9283_poses({{0.6, 0, 0.5}, 0.4}, exp_so3(Vector3(0, 3, 0)), 2);
  ASSERT_EQ(file.poses.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(file.labels(static_cast<Index>(k), 0), static_cast<int>(k) + 1);
    EXPECT_LT((file.poses[k].matrix() - expected[k].matrix()).norm(), 1e-9);
  }
}

TEST_F(Iso9283Program, RefusesWhatCannotBe) {
  write_visits(3);
  const auto refused = [&](const std::string& arguments, int exit_code, const std::string& words) {
    const CommandResult done = iso(arguments);
    EXPECT_EQ(done.exit_code, exit_code) << arguments;
    EXPECT_TRUE(done.one_line_of_errors()) << done.errors;
    EXPECT_NE(done.errors.find(words), std::string::npos) << done.errors;
  };
  refused("", 2, "--data, --path or --plan is required");
  refused("--data visits.csv", 2, "--data and --commanded belong together");
  refused("--runs visits.csv --data visits.csv --commanded poses.csv", 2, "--path and --runs belong together");
  refused("--plan --out p.csv", 2, "--plan needs --centre-mm X,Y,Z");
  refused("--plan --centre-mm 1,2,3 --edge-mm 400", 2, "--plan needs --out");
  refused("--plan --centre-mm 1,2,3 --edge-mm -4 --out p.csv", 2, "--edge-mm");
  refused("--plan --centre-mm 1,2,3 --edge-mm 4 --plane 5 --out p.csv", 2, "--plane");
  refused("--data missing.csv --commanded poses.csv", 1, "missing.csv: No such file or directory");
  refused("--data poses.csv --commanded poses.csv", 1, "poses.csv, line 1: no column cycle");
  write_file(folder_ / "odd.csv", "pose,x_mm,y_mm,z_mm\n1,0,0,0\n3,0,0,0\n");
  refused("--data visits.csv --commanded odd.csv", 1, "odd.csv: column pose must number its 2 poses 1, 2, ...");
  write_file(folder_ / "twice.csv", "pose,cycle,x_mm,y_mm,z_mm\n1,1,0,0,0\n1,1,0,0,0\n");
  refused("--data twice.csv --commanded poses.csv", 1, "pose 1, cycle 1, direction 0 is there twice");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p.csv"));
}

}  // namespace
}  // namespace vernier::iso9283_program_test
