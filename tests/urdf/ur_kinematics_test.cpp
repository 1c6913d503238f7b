// SPDX-License-Identifier: BSD-3-Clause
// The kinematics files of Universal Robots' driver.
#include "vernier/urdf/ur_kinematics.hpp"

#include <gtest/gtest.h>

#include "complaint.hpp"
#include "larger.hpp"
#include "random_chains.hpp"
#include "real_matrix.hpp"
#include "replaced.hpp"
#include "temporary_folder.hpp"
#include "ur_published.hpp"
#include "urdf_samples.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/ur_calibration.hpp"

namespace vernier::ur_kinematics_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;

class UrKinematicsFile : public testing::Test {
 protected:
  UrKinematics read(const std::string& text) const {
    write_file(path_, text);
    return read_ur_kinematics(path_);
  }
  RobotDescription calibrated(const vernier_test::UrDeltaSet& set) const {
    const std::string conf = (folder_ / "calibration.conf").string();
    write_file(conf, set.conf());
    return read_ur_calibration(conf, vernier_test::ur_nominal(set));
  }
  vernier_test::TemporaryFolder folder_{"ur_kinematics"};
  std::string path_ = (folder_ / "kinematics.yaml").string();
};

/// Rigid motions as matrices of 4 x 4: along x, y and z, and about one of them (0, 1, 2).
RealMatrix shift(double x, double y, double z) {
  return RealMatrix(4, 4, {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1});
}
RealMatrix turn(int axis, double angle) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  RealMatrix out = RealMatrix::identity(4);
  out(a, a) = out(b, b) = std::cos(angle);
  out(b, a) = std::sin(angle);
  out(a, b) = -std::sin(angle);
  return out;
}

/// What a URDF with these values as its origins gives.
RealMatrix described_pose(const std::array<Vector6, 6>& values, const JointVector<6>& q) {
  RealMatrix pose = RealMatrix::identity(4);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector6& v = values[i];
    pose = pose * shift(v(0), v(1), v(2)) * turn(2, v(5)) * turn(1, v(4)) * turn(0, v(3)) *
           turn(2, q(static_cast<Index>(i)));
  }
  return pose;
}

/// The numbers of a file, by its lines alone.
std::array<Vector6, 6> values_in(const std::string& text) {
  std::array<Vector6, 6> out;
  std::size_t at = text.find("\nkinematics:");
  for (Vector6& values : out)
    for (int k = 0; k < 6; ++k) {
      const char* names[] = {"    x: ", "    y: ", "    z: ", "    roll: ", "    pitch: ", "    yaw: "};
      at = text.find(names[k], at) + std::string(names[k]).size();
      values(k) = std::stod(text.substr(at));
    }
  return out;
}

// The published exporter writes angles of Rx Ry Rz, which the description reads as those of Rz Ry Rx; that slip is what
// the second half measures, so that the tolerance of the first half is known to see it.
TEST_F(UrKinematicsFile, IsExactForPublishedCalibrations) {
  Rng rng(1);
  for (const auto& set : vernier_test::ur_delta_sets()) {
    const RobotDescription nominal = vernier_test::ur_nominal(set);
    const UrKinematics exact = UrKinematics::of(calibrated(set).geometry(), "calib_1");
    const std::string text = exact.text({});
    const std::array<Vector6, 6> values = values_in(text);
    std::array<Vector6, 6> slipped;
    for (std::size_t i = 0; i < 6; ++i) {
      const Vector3 at = translation(exact.origins[i]), angles = rotation(exact.origins[i]).eulerAngles(0, 1, 2);
      slipped[i] = {at(0), at(1), at(2), angles(0), angles(1), angles(2)};
    }
    const RobotDescription again = read(text).robot("again");
    ASSERT_EQ(again.files.size(), 1u);
    EXPECT_EQ(again.files[0].hash, sha256(text));
    const auto back = again.arm<6>().arm;
    double worst = 0, worst_back = 0, slip = 0;
    for (int sample = 0; sample < 1000; ++sample) {
      const JointVector<6> q = vernier_test::random_joints<6>(rng);
      const RealMatrix truth = vernier_test::ur_controller_pose(nominal, set, q);
      worst = vernier_test::larger(worst, difference(described_pose(values, q), truth));
      worst_back = vernier_test::larger(worst_back, difference(back.pose(q), truth));
      slip = std::max(slip, (described_pose(slipped, q) - truth).block(0, 3, 3, 1).norm());
    }
    EXPECT_LE(worst, 1e-12) << set.name;
    EXPECT_LE(worst_back, 1e-12) << set.name;
    EXPECT_GT(slip, 1e-6) << set.name;
    EXPECT_LT(slip, 1e-4) << set.name;
    RecordProperty(std::string("slip_mm_") + set.name, message(slip * 1e3));
  }
}

TEST_F(UrKinematicsFile, TheNominalUr10IsThePublishedFile) {
  const UrKinematics kinematics = UrKinematics::of(RobotDescription::of(robots::ur10()).geometry(), "calib_2");
  const std::array<Vector6, 6> values = values_in(kinematics.text({}));
  constexpr double quarter = std::numbers::pi / 2;
  const double expected[6][6] = {{0, 0, 0.1273, 0, 0, 0},        {0, 0, 0, quarter, 0, 0},
                                 {-0.612, 0, 0, 0, 0, 0},        {-0.5723, 0, 0.163941, 0, 0, 0},
                                 {0, -0.1157, 0, quarter, 0, 0}, {0, 0.0922, 0, -quarter, 0, 0}};
  for (std::size_t i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(values[i](k), expected[i][k], 1e-15) << i << k;
}

// Rows of any geometry on a base: the same arm but for what lies behind the last axis, which is left to the tool.
TEST_F(UrKinematicsFile, OfAnyRowsIsTheArmUpToItsLastAxis) {
  Rng rng(3);
  const auto chain = vernier_test::random_chain<6>(rng, {.prismatic = 0});
  const Vector6 base_values{0.1, -0.2, 0.3, 0.4, -0.5, 0.6};
  const ArmGeometry arm(Framed<DhChain<6>>(chain, FrameParameters(base_values), FrameParameters()));
  const UrKinematics kinematics = UrKinematics::of(arm, "calib_4");
  EXPECT_EQ(kinematics.hash, "calib_4");
  const std::array<Vector6, 6> values = values_in(kinematics.text({}));
  const DhRow last = chain.row(5);
  const RealMatrix behind = shift(last.a, 0, 0) * turn(0, last.alpha) * turn(1, last.beta);
  MatrixX q(20, 6);
  for (Index i = 0; i < 20; ++i)
    for (Index j = 0; j < 6; ++j) q(i, j) = rng.uniform(-3, 3);
  const auto poses = arm.poses(q);
  const RobotDescription again = kinematics.robot("again");
  for (Index i = 0; i < 20; ++i) {
    JointVector<6> joints;
    for (Index j = 0; j < 6; ++j) joints(j) = q(i, j);
    EXPECT_LE(difference(described_pose(values, joints) * behind, poses[static_cast<std::size_t>(i)]), 1e-14) << i;
    EXPECT_LE(difference(again.arm<6>().arm.pose(joints), described_pose(values, joints)), 1e-13) << i;
  }
  EXPECT_EQ(again.name, "again");
  EXPECT_EQ(again.drives.size(), 6u);
  EXPECT_EQ(again.joint_names,
            (std::vector<std::string>{"shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"}));
  for (const auto& [lower, upper] : again.limits) {
    EXPECT_TRUE(std::isinf(lower) && lower < 0);
    EXPECT_TRUE(std::isinf(upper) && upper > 0);
  }
}

// Comments say what the file holds before the first value.
TEST_F(UrKinematicsFile, BeginsWithItsNote) {
  ExportNote note;
  note.robot = "cell 4";
  note.date = "2026-03-01";
  const std::string text = UrKinematics::of(RobotDescription::of(robots::ur10()).geometry(), "calib_5").text(note);
  std::string expected;
  for (const std::string& line : note.lines()) expected += "# " + line + "\n";
  expected +=
      "# The controller keeps its own calibration; joint values that it computes are by that one, not by this.\n"
      "kinematics:\n  shoulder:\n    x: 0\n";
  EXPECT_EQ(text.substr(0, expected.size()), expected);
}

TEST_F(UrKinematicsFile, OtherArmsAreRefused) {
  const auto told = [](int prismatic, bool modified) {
    std::vector<DhRow> rows(6, DhRow{.a = 0.1, .alpha = 0.5});
    if (prismatic >= 0) rows[static_cast<std::size_t>(prismatic)].joint = JointType::prismatic;
    const ArmGeometry arm(detail::ChainTable(rows, modified), {}, {});
    return vernier_test::complaint([&] { (void)UrKinematics::of(arm, ""); });
  };
  const std::string other = "UrKinematics: not an arm of six revolute joints in the standard convention";
  EXPECT_EQ(told(-1, false), "");
  EXPECT_EQ(told(-1, true), other);
  for (const int joint : {0, 3, 5}) EXPECT_EQ(told(joint, false), other);
}

// Joints of a URDF must turn about their own z, one next to the other.
TEST_F(UrKinematicsFile, JointsOfAUrdfFollowOneAnotherAboutTheirZ) {
  const auto told = [](const std::string& from, const std::string& to) {
    const std::string text = vernier_test::replaced(vernier_test::ur_like_urdf(), from, to);
    const UrdfChain chain = parse_urdf(text, "in", "base_link", "tool0");
    return vernier_test::complaint([&] { (void)UrKinematics::of(chain, chain.robot.geometry(), ""); });
  };
  const std::string elbow = "xyz=\"-0.612 0 0\"/>\n    <axis xyz=\"0 0 1\"/>";
  EXPECT_EQ(told(elbow, elbow), "");
  const std::string refused =
      "UrKinematics: joint 'elbow_joint' does not turn about its z axis next to the joint before, as those of "
      "Universal Robots do";
  EXPECT_EQ(told(elbow, "xyz=\"-0.612 0 0\"/>\n    <axis xyz=\"0 0 -1\"/>"), refused);
  EXPECT_EQ(told("<joint name=\"elbow_joint\" type=\"revolute\">", "<joint name=\"elbow_joint\" type=\"prismatic\">"),
            refused);
  EXPECT_EQ(
      told("<joint name=\"elbow_joint\" type=\"revolute\">\n    <parent link=\"upper_arm_link\"/>",
           "<link name=\"between\"/><joint name=\"bracket\" type=\"fixed\"><parent link=\"upper_arm_link\"/><child "
           "link=\"between\"/></joint>\n<joint name=\"elbow_joint\" type=\"revolute\">\n    <parent "
           "link=\"between\"/>"),
      refused);
}

TEST_F(UrKinematicsFile, OfAUrdfAreItsJointOrigins) {
  const UrdfChain chain = parse_urdf(vernier_test::ur_like_urdf(), "in", "base_link", "tool0");
  const UrKinematics kinematics = UrKinematics::of(chain, chain.robot.geometry(), "calib_3");
  EXPECT_EQ(kinematics.hash, "calib_3");
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LE(difference(kinematics.origins[i], chain.origins[i + 1]), 1e-14) << i;
  EXPECT_NE(vernier_test::complaint([] {
              const UrdfChain abb = parse_urdf(vernier_test::abb_like_urdf(), "in", "base_link", "tool0");
              (void)UrKinematics::of(abb, abb.robot.geometry(), "");
            }).find("joint 'joint_2' does not turn about its z axis"),
            std::string::npos);
  EXPECT_NE(vernier_test::complaint([] {
              const UrdfChain seven = parse_urdf(vernier_test::seven_axis_urdf(), "in");
              (void)UrKinematics::of(seven, seven.robot.geometry(), "");
            }).find("7 joints move, must be 6"),
            std::string::npos);
  EXPECT_NE(vernier_test::complaint([] {
              (void)UrKinematics::of(RobotDescription::of(robots::barrett_wam()).geometry(), "");
            }).find("not an arm of six revolute joints"),
            std::string::npos);
}

TEST_F(UrKinematicsFile, WhatTheDriverWritesIsRead) {
  const std::string published =
      "kinematics:\n  shoulder:\n    x: 0\n    y: 0\n    z: 0.1273\n    roll: -0\n    pitch: 0\n    yaw: -0\n"
      "  upper_arm: {x: 0, y: 0, z: 0, roll: 1.570796327, pitch: 0, yaw: -0}\n"
      "  forearm: {x: -0.612, y: 0, z: 0, roll: -0, pitch: 0, yaw: -0}\n"
      "  wrist_1: {x: -0.5723, y: 0, z: 0.163941, roll: -0, pitch: 0, yaw: -0}\n"
      "  wrist_2: {x: 0, y: -0.1157, z: -2.373046667922381e-11, roll: 1.570796327, pitch: 0, yaw: -0}\n"
      "  wrist_3: {x: 0, y: 0.0922, z: -1.891053610911353e-11, roll: 1.570796326589793, pitch: 3.141592653589793, "
      "yaw: 3.141592653589793}\n  hash: calib_17452164853672886207\n";
  const UrKinematics kinematics = read(published);
  EXPECT_EQ(kinematics.hash, "calib_17452164853672886207");
  Rng rng(2);
  const auto arm = kinematics.robot("ur10").arm<6>().arm;
  for (int i = 0; i < 100; ++i) {
    const JointVector<6> q = vernier_test::random_joints<6>(rng);
    EXPECT_LE(difference(arm.pose(q), robots::ur10().chain.pose(q)), 5e-9);
  }
  EXPECT_EQ(read(kinematics.text({})).hash, kinematics.hash);

  const auto expect = [&](const std::string& from, const std::string& to, const std::string& what) {
    const std::string told = vernier_test::complaint([&] { read(vernier_test::replaced(published, from, to)); });
    EXPECT_NE(told.find(what), std::string::npos) << told;
    EXPECT_NE(told.find("kinematics.yaml"), std::string::npos) << told;
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
  };
  expect("kinematics", "dynamics", "key 'kinematics' is missing");
  expect("  shoulder", "  - shoulder", "line 9: not valid YAML");
  expect(published, "", "must be a map of keys");
  expect("  forearm", "  fore", "key 'kinematics.forearm' is missing");
  expect("x: -0.612,", "", "line 10: key 'kinematics.forearm.x' is missing");
  expect("x: -0.612", "x: -0.6l2", "line 10: 'kinematics.forearm.x': '-0.6l2' is not a number");
  expect("x: -0.612", "x: -612000", "is beyond any length or angle");
  expect("x: -0.612", "x: .inf", "'.inf' is not a number");
  expect("x: -0.612", "x: [1]", "'kinematics.forearm.x' must be a number");
  expect("x: -0.612", "x: -0.612, x: -0.6", "key 'kinematics.forearm.x' is given twice");
  expect("{x: -0.612, y: 0, z: 0, roll: -0, pitch: 0, yaw: -0}", "5", "'kinematics.forearm' must be a map of keys");
  expect("hash: calib_17452164853672886207", "hash: {}", "'kinematics.hash' must be a text");
  for (const char* hash : {"a b", "\"a\\nb\"", "'~'", "''", "a#b"})
    expect("calib_17452164853672886207", hash,
           "line 14: 'kinematics.hash' must be of up to 64 letters, digits and underscores");
  expect("x: -0.612", "x: 1000.5", "'kinematics.forearm.x': 1000.5 is beyond any length or angle");
  EXPECT_EQ(read(vernier_test::replaced(published, "x: -0.612", "x: +1000")).origins[2](0, 3), 1000);
  const std::string longest(64, 'f');
  EXPECT_EQ(read(vernier_test::replaced(published, "calib_17452164853672886207", longest)).hash, longest);
  expect("calib_17452164853672886207", longest + "f", "must be of up to 64 letters");
  EXPECT_EQ(read(published + "#" + std::string((1 << 16) - 1 - published.size(), ' ')).hash, kinematics.hash);
  const std::string large = "#" + std::string(1 << 16, ' ');
  expect(published, large, "65537 bytes, more than 65536");
  EXPECT_EQ(read(vernier_test::replaced(published, "  hash: calib_17452164853672886207\n", "")).hash, "");
  UrKinematics without = kinematics;
  without.hash = "";
  EXPECT_EQ(read(without.text({})).hash, "");
  without.hash = "a\nb";
  EXPECT_EQ(vernier_test::complaint([&] { (void)without.text({}); }),
            "UrKinematics: the hash must be of up to 64 letters, digits and underscores");
  EXPECT_NE(vernier_test::complaint([&] { (void)read_ur_kinematics(path_ + "x"); }).find("yamlx"), std::string::npos);
}

}  // namespace
}  // namespace vernier::ur_kinematics_test
