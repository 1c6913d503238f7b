// SPDX-License-Identifier: BSD-3-Clause
// The factory calibration of Universal Robots' arms.
#include "vernier/io/ur_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "temporary_folder.hpp"
#include "ur_published.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"

namespace vernier::ur_calibration_test {
namespace {

using vernier_test::RealMatrix;

class UrCalibration : public ::testing::Test {
 protected:
  RobotDescription read(const std::string& text, const RobotDescription& nominal) const {
    write_file(path_, text);
    return read_ur_calibration(path_, nominal);
  }
  std::string complaint(const std::string& text) const {
    return vernier_test::complaint([&] { read(text, RobotDescription::of(robots::ur10())); });
  }
  /// The UR10's file with one line replaced.
  std::string changed(const std::string& key, const std::string& line) const {
    std::string text = vernier_test::ur_delta_sets()[0].conf();
    const std::size_t at = text.find(key);
    return text.replace(at, text.find('\n', at) - at, line);
  }
  vernier_test::TemporaryFolder folder_{"ur_calibration"};
  std::string path_ = (folder_ / "calibration.conf").string();
};

// 1e-12 m is what doubles leave of 440 m; a beta left out, or one delta of 1e-7, would show as 1e-7 m and more.
TEST_F(UrCalibration, PosesAreThoseOfTheControllersRows) {
  for (const auto& set : vernier_test::ur_delta_sets()) {
    const RobotDescription nominal = vernier_test::ur_nominal(set);
    const RobotDescription read_arm = read(set.conf(), nominal);
    ASSERT_EQ(read_arm.files.size(), 1u);
    EXPECT_EQ(read_arm.files[0].hash, sha256(set.conf()));
    const auto arm = read_arm.arm<6>();
    Rng rng(1);
    double worst = 0;
    for (int sample = 0; sample < 1000; ++sample) {
      const JointVector<6> q = vernier_test::random_joints<6>(rng, 6.28);
      const Isometry3 expected = vernier_test::ur_controller_pose(nominal, set, q);
      worst = vernier_test::larger(worst, vernier_test::difference(arm.arm.pose(q), expected));
    }
    EXPECT_LE(worst, 1e-12) << set.name;
    RecordProperty(std::string("worst_") + set.name, message(worst));
  }
}

TEST_F(UrCalibration, RowsAreNextToTheNominalOnes) {
  for (const auto& set : vernier_test::ur_delta_sets()) {
    const RobotDescription nominal = vernier_test::ur_nominal(set), robot = read(set.conf(), nominal);
    EXPECT_EQ(robot.name, nominal.name);
    EXPECT_EQ(robot.limits, nominal.limits);
    for (std::size_t i = 0; i < 6; ++i) {
      const DhRow &row = robot.rows[i], &design = nominal.rows[i];
      EXPECT_NEAR(row.a, design.a, 0.005) << set.name << i;
      EXPECT_NEAR(row.d, design.d, 0.005) << set.name << i;
      EXPECT_NEAR(row.alpha, design.alpha, 0.02) << set.name << i;
      EXPECT_NEAR(row.theta, design.theta, 0.1) << set.name << i;
      EXPECT_EQ(row.beta != 0, i == 1 || i == 2) << set.name << i;
    }
    EXPECT_EQ(robot.rows[1].d, 0);
    EXPECT_EQ(robot.rows[2].d, 0);
  }
}

TEST_F(UrCalibration, WithoutDeltasTheRowsAreNominal) {
  vernier_test::UrDeltaSet zero{};
  const RobotDescription nominal = RobotDescription::of(robots::ur10()), robot = read(zero.conf(), nominal);
  for (std::size_t i = 0; i < 6; ++i) {
    const DhRow &row = robot.rows[i], &design = nominal.rows[i];
    for (const double difference :
         {row.a - design.a, row.d - design.d, row.alpha - design.alpha, row.theta - design.theta, row.beta})
      EXPECT_NEAR(difference, 0, 1e-14) << i;
  }
}

// Two poses of the simulator of Universal Robots, whose pi / 2 is 1.570796327; same source as the deltas.
TEST_F(UrCalibration, PositionsOfTheSimulator) {
  constexpr double excess = 1.570796327 - std::numbers::pi / 2;
  const vernier_test::UrDeltaSet rounded{"rounded", {}, {}, {}, {excess, 0, 0, excess, -excess, 0}};
  const auto arm = read(rounded.conf(), RobotDescription::of(robots::ur10())).arm<6>().arm;
  const JointVector<6> first{-1.6007002035724084976209269370884, -1.7271001974688928726209269370884,
                             -2.2029998938189905288709269370884, -0.80799991289247685699592693708837,
                             1.59510004520416259765625,          -0.03099996248354131012092693708837};
  const JointVector<6> second{1.32645022869110107421875,
                              2.426007747650146484375,
                              5.951572895050048828125,
                              1.27409040927886962890625,
                              -0.54105216661562138824592693708837,
                              0.122173048555850982666015625};
  EXPECT_LE((arm.position(first) - Vector3(-0.179925914147547, -0.606869755162764, 0.230789102067257)).norm(), 1e-14);
  EXPECT_LE(
      (arm.position(second) - Vector3(0.39922988003280424074, 0.59688365069340565405, -0.66778190402763759614)).norm(),
      1e-14);
}

TEST_F(UrCalibration, FramesOfTheNominalArmStay) {
  RobotDescription nominal = RobotDescription::of(robots::ur10());
  nominal.base = rigid_motion(Matrix3::Identity(), Vector3(1, 2, 3));
  nominal.tool = rigid_motion(Matrix3::Identity(), Vector3(0, 0, 0.1));
  const auto& set = vernier_test::ur_delta_sets()[0];
  const RobotDescription robot = read(set.conf(), nominal);
  const JointVector<6> q{0.1, -1.2, 1.3, -0.4, 0.5, 0.6};
  const RealMatrix flange = vernier_test::ur_controller_pose(nominal, set, q),
                   expected = RealMatrix(nominal.base) * flange * nominal.tool;
  EXPECT_LE((RealMatrix(robot.arm<6>().arm.pose(q)) - expected).norm(), 1e-12);
}

TEST_F(UrCalibration, CommentsSpacesAndLineEndsAreAccepted) {
  const std::string text = vernier_test::ur_delta_sets()[0].conf();
  std::string windows = "# saved by the controller\r\n\r\n[other]\r\ndelta_a = 3\r\n";
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const RobotDescription nominal = RobotDescription::of(robots::ur10());
  std::string dense = text;
  dense.erase(std::remove(dense.begin(), dense.end(), ' '), dense.end());
  for (const std::string& other : {windows, dense}) EXPECT_EQ(read(other, nominal).rows, read(text, nominal).rows);
}

TEST_F(UrCalibration, DamageIsNamedInOneLine) {
  const auto expect = [&](const std::string& text, const std::string& what) {
    const std::string told = complaint(text);
    EXPECT_NE(told.find(what), std::string::npos) << told;
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
    EXPECT_NE(told.find("calibration.conf"), std::string::npos) << told;
  };
  expect("", "section [mounting] is missing");
  expect(changed("[mounting]", "[mount]"), "section [mounting] is missing");
  for (const std::string name : {"delta_theta", "delta_a", "delta_d", "delta_alpha"})
    expect(changed(name + " ", "other = [0, 0, 0, 0, 0, 0]"), "key '" + name + "' is missing");
  expect(changed("delta_a ", "delta_a = [1, 2, 3, 4, 5]"), "line 3: delta_a has 5 values, must have 6");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, 0, 0, 0, 0]"), "has 7 values");
  expect(changed("delta_a ", "delta_a = []"), "has 0 values");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, x, 0, 0]"), "'x' is not a number");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, , 0, 0]"), "'' is not a number");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, nan, 0, 0]"), "'nan' is not a number");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, 1e9, 0, 0]"), "is beyond any length or angle");
  expect(changed("delta_a ", "delta_a = 0, 0, 0, 0, 0, 0"), "must be a list");
  expect(changed("delta_a ", "delta_a = [0, 0, 0, 0, 0, 0"), "must be a list");
  expect(changed("delta_a ", "delta_a = 0, 0, 0, 0, 0, 0]"), "must be a list");
  expect(changed("delta_a ", "delta_a : 3"), "is neither a [section] nor key = value");
  expect(changed("delta_a ", "delta_d = [0, 0, 0, 0, 0, 0]"), "line 4: delta_d is given twice, also in line 3");
  expect(changed("delta_a ", "delta_a = [0, 2, 0, 0, 0, 0]"), "far from -0.612 m of 'ur10'; is it of another arm?");
  expect(std::string((1 << 20) + 1, '#'), "has more than 1 MiB");
  EXPECT_NE(vernier_test::complaint([&] {
              (void)read_ur_calibration((folder_ / "none").string(), RobotDescription::of(robots::ur10()));
            }).find("none"),
            std::string::npos);
  const std::string conf = vernier_test::ur_delta_sets()[0].conf();
  EXPECT_NE(vernier_test::complaint([&] {
              read(conf, RobotDescription::of(robots::barrett_wam()));
            }).find("is not an arm of six revolute joints"),
            std::string::npos);
}

// Half a turn is where atan2 jumps: a design just below it with a joint that was made just above.
TEST_F(UrCalibration, AnglesBeyondHalfATurnStayNextToTheDesign) {
  for (const double side : {1.0, -1.0}) {
    RobotDescription nominal = RobotDescription::of(robots::ur10());
    nominal.rows[5].theta = side * (std::numbers::pi - 0.05);
    const vernier_test::UrDeltaSet set{"beyond", {0, 0, 0, 0, 0, side * 0.1}, {}, {}, {}};
    EXPECT_NEAR(read(set.conf(), nominal).rows[5].theta, side * (std::numbers::pi + 0.05), 1e-12);
  }
}

/// Deltas that tilt the axis of joint 3 by an angle about y at its place in the design: rows without beta reach it over
/// a quarter turn and far along both axes, as those of real arms do.
vernier_test::UrDeltaSet axis_3_tilted(double angle, double a2) {
  const double quarter = std::numbers::pi / 2, along_2 = -a2 / std::tan(angle), along_3 = a2 / std::sin(angle);
  return {"tilted",
          {0, quarter, -quarter, 0, 0, 0},
          {0, -a2, 0, 0, 0, 0},
          {0, along_2, along_3, 0, 0, 0},
          {0, angle, 0, 0, 0, 0}};
}

TEST_F(UrCalibration, AxesThatAreNotParallelHaveABeta) {
  const RobotDescription nominal = RobotDescription::of(robots::ur10());
  const double a2 = nominal.rows[1].a;
  for (const double angle : {-0.15, 0.15}) {
    const RobotDescription robot = read(axis_3_tilted(angle, a2).conf(), nominal);
    for (std::size_t i = 0; i < 6; ++i) {
      const DhRow &row = robot.rows[i], &design = nominal.rows[i];
      EXPECT_NEAR(row.beta, i == 1 ? angle : 0, 1e-12) << i;
      for (const double difference :
           {row.a - design.a, row.d - design.d, row.alpha - design.alpha, row.theta - design.theta})
        EXPECT_NEAR(difference, 0, 1e-12) << i;
    }
  }
}

TEST_F(UrCalibration, ATwistOfAnotherArmIsRefused) {
  vernier_test::UrDeltaSet set{};
  set.alpha[0] = 0.29;
  EXPECT_EQ(complaint(set.conf()), "");
  set.alpha[0] = 0.31;
  const std::string told = complaint(set.conf());
  EXPECT_NE(told.find("alpha1 becomes 1.8"), std::string::npos) << told;  // pi / 2 + 0.31
}

}  // namespace
}  // namespace vernier::ur_calibration_test
