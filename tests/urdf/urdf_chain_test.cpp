// SPDX-License-Identifier: BSD-3-Clause
// Chains of URDF files: rows against the catalogue, and what is refused.
#include "vernier/urdf/urdf_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "replaced.hpp"
#include "temporary_folder.hpp"
#include "urdf_samples.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/urdf/detail/roll_pitch_yaw.hpp"

namespace vernier::urdf_chain_test {
namespace {

using vernier_test::RealMatrix;

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(UrdfChain, RowsOfAUr10AreThoseOfTheCatalogue) {
  const UrdfChain chain = parse_urdf(vernier_test::ur_like_urdf(), "ur.urdf", "base_link_inertia", "tool0");
  EXPECT_EQ(chain.robot.name, "ur_like");
  EXPECT_EQ(chain.base_link, "base_link_inertia");
  EXPECT_EQ(chain.tip_link, "tool0");
  EXPECT_EQ(chain.joints.size(), 8u);
  EXPECT_EQ(chain.robot.joint_names,
            (std::vector<std::string>{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint",
                                      "wrist_2_joint", "wrist_3_joint"}));
  EXPECT_LE((chain.robot.base.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-15);
  const auto nominal = robots::ur10().chain;
  for (int i = 0; i < 5; ++i) {  // the last row is zero, its d in the tool
    const DhRow &row = chain.robot.rows[static_cast<std::size_t>(i)], &design = nominal.row(i);
    for (const double difference : {row.a - design.a, row.alpha - design.alpha, row.d - design.d,
                                    row.theta - design.theta, row.beta - design.beta})
      EXPECT_NEAR(difference, 0, 1e-9) << i;  // the file's pi / 2 has ten digits
  }
  EXPECT_EQ(chain.robot.rows.back(), DhRow{});
  EXPECT_NEAR(chain.robot.tool.translation().z(), 0.0922, 1e-9);
  EXPECT_EQ(chain.robot.limits[2], (std::pair{-3.141592653589793, 3.141592653589793}));
  EXPECT_EQ(chain.robot.drives.size(), 6u);
}

TEST(UrdfChain, RowsOfAnIrb120AreThoseOfTheCatalogue) {
  const UrdfChain chain = parse_urdf(vernier_test::abb_like_urdf(), "abb.urdf", "base_link", "tool0");
  const auto nominal = robots::abb_irb120().chain;
  for (int i = 0; i < 5; ++i) {
    const DhRow &row = chain.robot.rows[static_cast<std::size_t>(i)], &design = nominal.row(i);
    for (const double difference : {row.a - design.a, row.alpha - design.alpha, row.d - design.d,
                                    row.theta - design.theta, row.beta - design.beta})
      EXPECT_NEAR(difference, 0, 1e-14) << i;
  }
  EXPECT_EQ(chain.robot.limits.back(), (std::pair{-infinity, infinity}));  // continuous
  ASSERT_EQ(chain.remarks.size(), 1u);
  EXPECT_EQ(chain.remarks[0], "joint 'joint_3': <calibration> is ignored");
}

/// A rigid motion as a matrix of 4 x 4: a shift, and a rotation about a unit vector by Rodrigues' formula.
RealMatrix motion(const Vector3& shift, const Vector3& axis, double angle) {
  const RealMatrix cross(3, 3, {0, -axis(2), axis(1), axis(2), 0, -axis(0), -axis(1), axis(0), 0});
  RealMatrix out = RealMatrix::identity(4);
  out.set_block(0, 0, RealMatrix::identity(3) + std::sin(angle) * cross + (1 - std::cos(angle)) * (cross * cross));
  out.set_block(0, 3, shift);
  return out;
}
RealMatrix origin_of(const Vector3& xyz, const Vector3& rpy) {
  return motion(xyz, {0, 0, 1}, rpy(2)) * motion({0, 0, 0}, {0, 1, 0}, rpy(1)) * motion({0, 0, 0}, {1, 0, 0}, rpy(0));
}

/// Joints of all kinds, axes of any length, or none, which means x; fixed joints everywhere.
const std::string mixed_urdf =
    "<robot name='mixed'><link name='a'/><link name='b'/><link name='c'/><link name='d'/><link name='e'/><link "
    "name='f'/><link name='g'/><link name='h'/>\n"
    "<joint name='foot' type='fixed'><parent link='a'/><child link='b'/><origin xyz='0.1 -0.2 0.3' rpy='0.4 0.5 "
    "-0.6'/></joint>\n"
    "<joint name='turn' type='revolute'><parent link='b'/><child link='c'/><origin xyz='+0.2 0 0.1' rpy='0 0 "
    "1'/><axis xyz='3 6 6'/><limit upper='1.5'/></joint>\n"
    "<joint name='spin' type='continuous'><parent link='c'/><child link='d'/><origin rpy='0.7 0 0.2'/><axis/><limit "
    "lower='-1' upper='1'/></joint>\n"
    "<joint name='bracket' type='fixed'><parent link='d'/><child link='e'/><origin xyz='0 0.3 0' rpy='0 -0.3 "
    "0'/><limit lower='1' upper='1'/></joint>\n"
    "<joint name='slide' type='prismatic'><parent link='e'/><child link='f'/><origin xyz='0 0 0.4'/><axis xyz='0 "
    "0.001 -0.001'/><limit lower='-0.2' upper='0.3'/><safety_controller/></joint>\n"
    "<joint name='hinge' type='revolute'><parent link='f'/><child link='g'/><origin xyz='0.3 0 0' rpy='0 1 "
    "0'/><axis xyz='0 -1 0'/><limit lower='0.5' upper='0.5'/></joint>\n"
    "<joint name='hand' type='fixed'><parent link='g'/><child link='h'/><origin xyz='0.05 0.06 0.07' rpy='1 2 "
    "3'/><mimic joint='turn'/></joint></robot>";

// A joint of a parallelogram follows two joints before it: the chain has it, the controller does not.
TEST(UrdfChain, AJointThatMimicsIsPassive) {
  std::string text = mixed_urdf;
  const std::string plain = "0'/><axis xyz='0 -1 0'/>";
  ASSERT_NE(text.find(plain), std::string::npos);
  text.replace(text.find(plain), plain.size(),
               "0'/><axis xyz='0 -1 0'/><mimic joint='turn' multiplier='-2' offset='0.25'/>");
  const UrdfChain chain = parse_urdf(text, "mixed.urdf"), all = parse_urdf(mixed_urdf, "mixed.urdf");
  const ControllerMap& controller = chain.robot.controller;
  ASSERT_EQ(chain.robot.dof(), 4);
  ASSERT_EQ(chain.robot.controller_joints(), 3);
  EXPECT_EQ(chain.robot.limits.size(), 3u);
  EXPECT_TRUE(all.robot.controller.same());
  const MatrixX shown{{0.3, -0.7, 0.1}};
  EXPECT_EQ(controller.to_chain(shown), (MatrixX{{0.3, -0.7, 0.1, -0.35}}));
  EXPECT_EQ(controller.to_controller(controller.to_chain(shown)), shown);
  EXPECT_TRUE(chain.robot.geometry().parameters() == all.robot.geometry().parameters());
}

TEST(UrdfChain, PosesAreProductsOfOriginsAndJointMotions) {
  const UrdfChain chain = parse_urdf(mixed_urdf, "mixed.urdf");
  const ArmGeometry arm = chain.robot.geometry();
  ASSERT_EQ(arm.joints(), 4);
  MatrixX q(5, 4);
  Rng rng(3);
  for (double& value : q.reshaped()) value = rng.uniform(-3, 3);
  const auto poses = arm.poses(q);
  for (Index i = 0; i < 5; ++i) {
    const Vector3 slid(0, q(i, 2) * std::sqrt(0.5), -q(i, 2) * std::sqrt(0.5));
    const RealMatrix expected = origin_of({0.1, -0.2, 0.3}, {0.4, 0.5, -0.6}) * origin_of({0.2, 0, 0.1}, {0, 0, 1}) *
                                motion({0, 0, 0}, Vector3(1, 2, 2) / 3, q(i, 0)) * origin_of({0, 0, 0}, {0.7, 0, 0.2}) *
                                motion({0, 0, 0}, {1, 0, 0}, q(i, 1)) * origin_of({0, 0.3, 0}, {0, -0.3, 0}) *
                                origin_of({0, 0, 0.4}, {0, 0, 0}) * motion(slid, {1, 0, 0}, 0) *
                                origin_of({0.3, 0, 0}, {0, 1, 0}) * motion({0, 0, 0}, {0, -1, 0}, q(i, 3)) *
                                origin_of({0.05, 0.06, 0.07}, {1, 2, 3});
    EXPECT_LT(vernier_test::difference(poses[static_cast<std::size_t>(i)], expected), 1e-14) << i;
  }
  EXPECT_EQ(chain.joints, (std::vector<std::string>{"foot", "turn", "spin", "bracket", "slide", "hinge", "hand"}));
  EXPECT_EQ(chain.robot.joint_names, (std::vector<std::string>{"turn", "spin", "slide", "hinge"}));
  EXPECT_EQ(chain.moving, (std::vector<int>{1, 2, 4, 5}));
}

// A limit that is not given is 0; a joint that turns on and on has none, nor one whose limits leave nothing.
TEST(UrdfChain, LimitsAndRemarksAreThoseOfJointsThatMove) {
  const UrdfChain chain = parse_urdf(mixed_urdf, "mixed.urdf");
  using Limits = std::vector<std::pair<double, double>>;
  EXPECT_EQ(chain.robot.limits, (Limits{{0, 1.5}, {-infinity, infinity}, {-0.2, 0.3}, {-infinity, infinity}}));
  EXPECT_EQ(chain.remarks, (std::vector<std::string>{
                               "joint 'slide': <safety_controller> is ignored",
                               "joint 'hinge': its limit, whose upper value is not above the lower one, is ignored"}));
}

TEST(UrdfChain, UpTo64JointsMayMove) {
  const auto chain_of = [](int joints) {
    std::string out = "<robot name='snake'><link name='l0'/>";
    for (int i = 1; i <= joints; ++i)
      out += message("<link name='l", i, "'/><joint name='j", i, "' type='revolute'><parent link='l", i - 1,
                     "'/><child link='l", i, "'/><origin xyz='0.1 0 0'/></joint>");
    return out + "</robot>";
  };
  EXPECT_EQ(parse_urdf(chain_of(64), "snake.urdf").robot.dof(), 64);
  EXPECT_EQ(vernier_test::complaint([&] { (void)parse_urdf(chain_of(65), "snake.urdf"); }),
            "snake.urdf: 65 joints move between link 'l0' and link 'l65'; there must be 1 to 64");
  // of many links some are named
  EXPECT_EQ(vernier_test::complaint([&] { (void)parse_urdf(chain_of(7), "snake.urdf", "l0", "l8"); }),
            "snake.urdf: there is no link 'l8'; there are 'l0', 'l1', 'l2', 'l3', 'l4', 'l5', 'l6', 'l7'");
  EXPECT_EQ(vernier_test::complaint([&] { (void)parse_urdf(chain_of(8), "snake.urdf", "l0", "l9"); }),
            "snake.urdf: there is no link 'l9'; there are 'l0', 'l1', 'l2', 'l3', 'l4', 'l5', 'l6', 'l7', ... (9)");
}

TEST(UrdfChain, BaseAndTipAreFoundWhereThereIsOneOfEach) {
  const UrdfChain chain = parse_urdf(vernier_test::seven_axis_urdf(), "seven.urdf");
  EXPECT_EQ(chain.base_link, "link_0");
  EXPECT_EQ(chain.tip_link, "link_7");
  EXPECT_EQ(chain.robot.dof(), 7);
  EXPECT_NE(vernier_test::complaint([] {
              (void)parse_urdf(vernier_test::ur_like_urdf(), "ur.urdf");
            }).find("ur.urdf: which link is the tip? There are 'base', 'tool0'"),
            std::string::npos);
}

// Gravity acts along -z of the base link, wherever the first axis points: upright, hanging, or along a rail.
TEST(UrdfChain, GravityActsDownwardsInTheBaseLink) {
  struct Case {
    const char *type, *axis;
    double along;  // of gravity along the z axis of the first row
  };
  for (const Case& one : {Case{"revolute", "0 0 1", -1}, Case{"revolute", "0 0 -1", 1}, Case{"prismatic", "1 0 0", 0},
                          Case{"prismatic", "0 0.6 0.8", -0.8}}) {
    const UrdfChain chain = parse_urdf(message("<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='",
                                               one.type, "'><parent link='a'/><child link='b'/><axis xyz='", one.axis,
                                               "'/><limit lower='-1' upper='1'/></joint></robot>"),
                                       "r.urdf");
    EXPECT_NEAR(chain.robot.down.z(), one.along, 1e-12) << one.axis;
    EXPECT_LT((chain.robot.base.linear() * chain.robot.down + Vector3::UnitZ()).norm(), 1e-12) << one.axis;
    EXPECT_TRUE(chain.robot.down_stated);
  }
}

TEST(UrdfChain, PartOfATreeIsAChainToo) {
  const UrdfChain chain = parse_urdf(vernier_test::abb_like_urdf(), "abb.urdf", "link_1", "plate");
  EXPECT_EQ(chain.robot.joint_names, (std::vector<std::string>{"joint_2", "joint_3"}));
  EXPECT_EQ(parse_urdf(vernier_test::abb_like_urdf(), "abb.urdf", "tool0", "left_finger").robot.rows.front().joint,
            JointType::prismatic);
}

TEST(UrdfChain, FilesAreRead) {
  const vernier_test::TemporaryFolder folder("urdf");
  const std::string path = (folder / "seven.urdf").string();
  write_file(path, "\xEF\xBB\xBF" + vernier_test::seven_axis_urdf());
  EXPECT_EQ(read_urdf(path).robot.rows, parse_urdf(vernier_test::seven_axis_urdf(), "x").robot.rows);
  ASSERT_EQ(read_urdf(path).robot.files.size(), 1u);
  EXPECT_EQ(read_urdf(path).robot.files[0].hash, sha256("\xEF\xBB\xBF" + vernier_test::seven_axis_urdf()));
  EXPECT_NE(vernier_test::complaint([&] { (void)read_urdf(path + "x"); }).find("seven.urdfx"), std::string::npos);
}

TEST(UrdfChain, DamageIsNamedInOneLine) {
  const auto expect = [](const std::string& text, const std::string& what, const char* base = "link_0",
                         const char* tip = "link_7") {
    const std::string told = vernier_test::complaint([&] { (void)parse_urdf(text, "a.urdf", base, tip); });
    EXPECT_NE(told.find(what), std::string::npos) << "expected: " << what << "\ntold: " << told;
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
    EXPECT_EQ(told.find("a.urdf"), 0u) << told;
  };
  const std::string& good = vernier_test::seven_axis_urdf();
  const auto with = [&](const std::string& from, const std::string& to) {
    return vernier_test::replaced(good, from, to);
  };
  expect("", "empty, not URDF");
  expect("joints", "not valid XML");
  expect(good.substr(0, good.size() / 2), "not valid XML");
  expect(with("</robot>", ""), "not valid XML");
  expect(with("<child link=\"link_1\"/>", "</child link=\"link_1\"/>"), "line 7: not valid XML (start and end tags");
  expect(with("<robot name=\"seven\">", "<robot>"), "line 2: the robot has no name");
  expect("<model name='x'/>", "outermost element is not 'robot'");
  expect(good + "<robot name='second'/>", "a second root element");
  expect(with("<robot name", "<!DOCTYPE robot [<!ENTITY a SYSTEM \"/etc/passwd\">]>\n<robot name"),
         "line 2: a document type or entity declaration");
  expect(with("<link name=\"link_0\"/>", "<link name=\"link_0\"/><xi:include href=\"other.urdf\"/>"),
         "line 3: 'xi:include': other files are not included");
  expect(with("<link name=\"link_0\"/>", "<xacro:include filename=\"a.xacro\"/>"),
         "line 3: 'xacro:include' is of xacro: run xacro first");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 ${height}\""), "is a xacro expression: run xacro first");
  std::string deep = good;
  deep.insert(deep.find("</robot>"), [] {
    std::string open, close;
    for (int i = 0; i < 60; ++i) {
      open += "<a>";
      close += "</a>";
    }
    return open + close;
  }());
  expect(deep, "nested deeper than 50");
  deep.insert(deep.find("<a>"), [] {
    std::string open;
    for (int i = 0; i < 100000; ++i) open += "<a>";
    return open;
  }());
  expect(deep, "nested too deeply");
  expect(std::string(17u << 20u, ' '), "17825792 bytes, more than 16777216");
  expect(with("link name=\"link_1\"", "link name=\"link_0\""), "line 4: link 'link_0' is also in line 3");
  expect(with("joint name=\"joint_a2\"", "joint name=\"joint_a1\""), "joint 'joint_a1' is also in line 5");
  expect(with("<link name=\"link_1\"/>", "<link/>"), "line 4: a link has no name");
  expect(with("<joint name=\"joint_a1\"", "<joint name=\"\""), "line 5: a joint has no name");
  expect(with("<joint name=\"joint_a1\" type=\"revolute\"", "<joint name=\"joint_a1\""),
         "joint 'joint_a1' has no type");
  expect(with("type=\"revolute\"", "type=\"ball\""), "type 'ball' is unknown");
  expect(with("type=\"revolute\"", "type=\"floating\""), "joint 'joint_a1' of the chain is floating");
  expect(with("type=\"revolute\"", "type=\"planar\""), "joint 'joint_a1' of the chain is planar");
  expect(with("<axis", "<mimic joint=\"joint_a9\"/><axis"),
         "joint 'joint_a1' mimics 'joint_a9', which is no joint of the chain that moves by itself");
  expect(with("<axis", "<mimic joint=\"joint_a2\" multiplier=\"0.5\"/><axis"),
         "joint 'joint_a1' mimics 'joint_a2', by a multiplier of 0.5; it must be a whole number");
  expect(with("<axis", "<mimic joint=\"joint_a2\" multiplier=\"0\"/><axis"), "by a multiplier of 0;");
  expect(with("<axis", "<mimic/><axis"), "the mimic of joint 'joint_a1' has no joint");
  expect(with("<parent link=\"link_0\"/>", ""), "joint 'joint_a1' has no parent");
  expect(with("<child link=\"link_1\"/>", "<child/>"), "the child of joint 'joint_a1' has no link");
  expect(with("<parent link=\"link_0\"/>", "<parent link=\"link_0\"/><parent link=\"link_0\"/>"),
         "joint 'joint_a1' has two elements 'parent'");
  expect(with("<parent link=\"link_0\"/>", "<parent link=\"ground\"/>"), "joint 'joint_a1': link 'ground' is missing");
  expect(with("<child link=\"link_2\"/>", "<child link=\"link_1\"/>"),
         "link 'link_1' has another parent, by joint 'joint_a1'");
  expect(with("<parent link=\"link_0\"/>", "<parent link=\"link_7\"/>"), "is above itself, a cycle of joints");
  expect(with("<parent link=\"link_2\"/>", "<parent link=\"link_3\"/>"), "link 'link_3' is above itself");
  expect(with("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"), "the axis of joint 'joint_a1' is zero");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0\""), "xyz of joint 'joint_a1' has 2 numbers, must have 3");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 1 2\""), "has 4 numbers");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 0,1575\""), "'0,1575' is not a number");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 nan\""), "'nan' is not a number");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 1575\""), "1575 is beyond any length or angle");
  expect(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 -1000.5\""), "-1000.5 is beyond any length or angle");
  EXPECT_EQ(parse_urdf(with("xyz=\"0 0 0.1575\"", "xyz=\"0 0 1000\""), "a.urdf").origins[0](2, 3), 1000);
  expect(with("lower=\"-2.9\"", "lower=\"x\""), "lower of joint 'joint_a1': 'x' is not a number");
  expect(good, "there is no link 'flange'", "link_0", "flange");
  expect(with("<link name=\"link_0\"/>", "<link name=\"a&#10;b\"/><link name=\"link_0\"/>"),
         "there is no link 'flange'; there are 'a", "link_0", "flange");
  expect(good, "link 'link_0' is not behind link 'link_7'; it is behind none", "link_7", "link_0");
  expect(vernier_test::ur_like_urdf(), "link 'tool0' is not behind link 'base'; it is behind 'flange', 'wrist_3_link'",
         "base", "tool0");
  expect(good, "0 joints move between link 'link_2' and link 'link_2'", "link_2", "link_2");
}

TEST(UrdfChain, LimitsThatAreNoneAreIgnoredWithARemark) {
  const UrdfChain chain =
      parse_urdf(vernier_test::replaced(vernier_test::seven_axis_urdf(), "lower=\"-2.9\" upper=\"2.9\"", ""), "a.urdf");
  EXPECT_EQ(chain.robot.limits[0], (std::pair{-infinity, infinity}));
  EXPECT_EQ(chain.robot.limits[1], (std::pair{-2.9, 2.9}));
  ASSERT_EQ(chain.remarks.size(), 1u);
  EXPECT_EQ(chain.remarks[0], "joint 'joint_a1': its limit, whose upper value is not above the lower one, is ignored");
}

TEST(RollPitchYaw, IsExactAtAndNextToTheSingularity) {
  Rng rng(1);
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const double pitch_off[] = {0, 1e-15, 1e-13, 1e-10, 1e-8, 1e-5, 1e-3, 1};
    const Vector3 rpy(rng.uniform(-3.2, 3.2), (i % 2 ? 1 : -1) * (std::numbers::pi / 2 - pitch_off[i % 8]),
                      rng.uniform(-3.2, 3.2));
    const Matrix3 rotation =
        (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
            .toRotationMatrix();
    EXPECT_LE((detail::from_roll_pitch_yaw(rpy) - rotation).cwiseAbs().maxCoeff(), 2e-15);
    worst = std::max(worst,
                     (detail::from_roll_pitch_yaw(detail::roll_pitch_yaw(rotation)) - rotation).cwiseAbs().maxCoeff());
  }
  EXPECT_LE(worst, 2e-12);
  RecordProperty("worst", message(worst));
}

}  // namespace
}  // namespace vernier::urdf_chain_test
