// SPDX-License-Identifier: BSD-3-Clause
// Versions of URDF and what is not of URDF: quaternions, and attributes and elements that may move a frame.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/urdf/export_urdf.hpp"
#include "vernier/urdf/urdf_chain.hpp"

namespace vernier::urdf_versions_test {
namespace {

using vernier_test::RealMatrix;

/// An arm of two joints, with parts of its text to be chosen.
struct Parts {
  std::string robot = "version='1.1'", origin = "xyz='0.3 0 0.75' rpy='0.3 -0.4 0.5'", in_joint{}, in_robot{},
              axis = "<axis xyz='0 0 1'/>", limit = "<limit lower='-1' upper='1'/>", parent = "<parent link='b'/>",
              joint{}, origin_content{};
};
std::string urdf(const Parts& p) {
  return "<robot name='a' " + p.robot + ">\n<link name='a'/><link name='b'/><link name='c'/><link name='d'/>" +
         p.in_robot +
         "\n<joint name='one' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>"
         "<limit lower='-1' upper='1'/></joint>\n<joint name='two' type='revolute' " +
         p.joint + ">" + p.parent + "<child link='c'/><origin " + p.origin + ">" + p.origin_content + "</origin>" +
         p.axis + p.limit + p.in_joint +
         "</joint>\n<joint name='end' type='fixed'><parent link='c'/><child link='d'/><origin xyz='0.1 0.2 0.3'/>"
         "</joint></robot>";
}

/// Rotation by a unit quaternion, as a vector is turned: v + 2 w (u x v) + 2 u x (u x v).
RealMatrix rotation(double x, double y, double z, double w) {
  const RealMatrix cross(3, 3, {0, -z, y, z, 0, -x, -y, x, 0});
  return RealMatrix::identity(3) + (2 * w) * cross + 2 * (cross * cross);
}

RealMatrix origin_of_two(const std::string& attributes, const std::string& robot = "version='1.1'") {
  const UrdfChain chain = parse_urdf(urdf({.robot = robot, .origin = attributes}), "a.urdf");
  RealMatrix out(3, 3);
  for (Index r = 0; r < 3; ++r)
    for (Index c = 0; c < 3; ++c) out(r, c) = chain.origins[1](r, c);
  return out;
}

TEST(UrdfVersions, QuaternionsAreRotations) {
  const double h = std::sqrt(0.5);
  for (const auto& [text, x, y, z, w] : std::vector<std::tuple<std::string, double, double, double, double>>{
           {"0.7071067811865476 0 0 0.7071067811865476", h, 0, 0, h},
           {"0 0 0 1", 0, 0, 0, 1},
           {"0 0 0 -1", 0, 0, 0, 1},
           {"0.1 -0.5 0.7 0.5", 0.1, -0.5, 0.7, 0.5},
           {"\n 1e0\t0  0 0 ", 1, 0, 0, 0},
           {"-0.6 0 0.8 0", -0.6, 0, 0.8, 0}})
    EXPECT_LT(vernier_test::difference(origin_of_two("quat_xyzw='" + text + "'"), rotation(x, y, z, w)), 1e-15) << text;
  // digits that were cut off are no other rotation
  EXPECT_LT(vernier_test::difference(origin_of_two("quat_xyzw='0.707 0 0 0.707'"), rotation(h, 0, 0, h)), 1e-15);
  // the zero pose of the arm in the fault report, by hand: b at (0.3, 0, 0.75), then a quarter turn about x
  const UrdfChain chain =
      parse_urdf(urdf({.origin = "xyz='0.3 0 0.75' quat_xyzw='0.7071067811865476 0 0 0.7071067811865476'"}), "a.urdf");
  const Vector3 tip = chain.robot.geometry().poses(MatrixX::Zero(1, 2)).front().translation();
  EXPECT_LT((tip - Vector3(0.4, -0.3, 0.95)).norm(), 1e-15);
}

TEST(UrdfVersions, WhatIsNoQuaternionIsRefused) {
  const auto refused = [](const std::string& origin, const std::string& robot = "version='1.1'") {
    return vernier_test::complaint([&] { (void)parse_urdf(urdf({.robot = robot, .origin = origin}), "a.urdf"); });
  };
  EXPECT_EQ(refused("quat_xyzw='2 0 0 0'"), "a.urdf, line 4: quat_xyzw of joint 'two' has the length 2, must be 1");
  for (const char* other : {"0 0 0 0", "0.5 0.5 0.5 0.4", "0.99 0 0 0"})
    EXPECT_NE(refused(std::string("quat_xyzw='") + other + "'").find("must be 1"), std::string::npos) << other;
  EXPECT_EQ(refused("quat_xyzw='0 0 1'"), "a.urdf, line 4: quat_xyzw of joint 'two' has 3 numbers, must have 4");
  EXPECT_EQ(refused("quat_xyzw='0 0 nan 1'"), "a.urdf, line 4: quat_xyzw of joint 'two': 'nan' is not a number");
  EXPECT_EQ(refused("quat_xyzw='0 0 0 1' rpy='0 0 0'"),
            "a.urdf, line 4: the origin of joint 'two' has both rpy and quat_xyzw");
  for (const char* version : {"", "version='1.0'"})
    EXPECT_NE(refused("quat_xyzw='0 0 0 1'", version).find("line 4: quat_xyzw of joint 'two' is of URDF 1.1"),
              std::string::npos);
}

TEST(UrdfVersions, OfTheFile) {
  for (const char* version : {"", "version='1.0'", "version='1.1'"})
    EXPECT_EQ(parse_urdf(urdf({.robot = version}), "a.urdf").robot.dof(), 2) << version;
  for (const char* version : {"2.0", "1.2", "1", "1.0.0", "one", ""})
    EXPECT_EQ(vernier_test::complaint(
                  [&] { (void)parse_urdf(urdf({.robot = message("version='", version, "'")}), "a.urdf"); }),
              message("a.urdf, line 1: version '", version, "' of URDF; 1.0 and 1.1 are read"));
}

TEST(UrdfVersions, WhatMayMoveAFrameIsRefused) {
  const auto refused = [](const Parts& parts) {
    return vernier_test::complaint([&] { (void)parse_urdf(urdf(parts), "a.urdf"); });
  };
  for (const char* name : {"quat_wxyz", "ypr", "frame", "XYZ", "rpy_deg", "scale", "relative_to"})
    EXPECT_EQ(
        refused({.origin = message("xyz='0 0 1' ", name, "='1 0 0'")}),
        message("a.urdf, line 4: the origin of joint 'two' has an attribute '", name, "', which is not known there"));
  EXPECT_NE(refused({.origin = "xyz='0 0 1' xyz='0 0 2'"}).find("line 4: not valid XML"), std::string::npos);
  EXPECT_NE(refused({.origin_content = "0 0 1 0 0 0"}).find("the origin of joint 'two' has a content"),
            std::string::npos);
  EXPECT_NE(refused({.origin_content = "<xyz>0 0 1</xyz>"}).find("has a content 'xyz'"), std::string::npos);
  EXPECT_EQ(refused({.origin_content = "<!-- nothing -->"}), "");
  EXPECT_NE(refused({.axis = "<axis xyz='0 0 1' expressed_in='__model__'/>"})
                .find("the axis of joint 'two' has an attribute"),
            std::string::npos);
  EXPECT_NE(refused({.axis = "<axis><xyz>0 1 0</xyz></axis>"}).find("the axis of joint 'two' has a content 'xyz'"),
            std::string::npos);
  EXPECT_NE(
      refused({.parent = "<parent link='b' xyz='0 0 1'/>"}).find("the parent of joint 'two' has an attribute 'xyz'"),
      std::string::npos);
  for (const char* element : {"<pose>0 0 1 0 0 0</pose>", "<transform/>", "<offset xyz='0 0 1'/>", "<x rpy='1 0 0'/>",
                              "<axis2 xyz='0 1 0'/>", "<Frame/>"})
    EXPECT_NE(refused({.in_joint = element}).find("' of joint 'two' is not known, and may move its frame"),
              std::string::npos)
        << element;
  for (const auto& [element, name] : {std::pair{"<Origin xyz='0 0 1'/>", "origin"},
                                      {"<AXIS xyz='1 0 0'/>", "axis"},
                                      {"<Mimic joint='one'/>", "mimic"}})
    EXPECT_NE(refused({.in_joint = element}).find(message("is not known; is it '", name, "'?")), std::string::npos)
        << element;
  EXPECT_EQ(refused({.in_robot = "<Joint name='x' type='fixed'/>"}),
            "a.urdf, line 2: 'Joint' is not known; is it 'joint'?");
  EXPECT_EQ(refused({.in_robot = "<Link name='x'/>"}), "a.urdf, line 2: 'Link' is not known; is it 'link'?");
  EXPECT_NE(refused({.in_robot = "<include><uri>model://hand</uri></include>"}).find("are not included"),
            std::string::npos);
}

// Elsewhere in the tree, or without a place in space, they do no harm; on the chain they are listed.
TEST(UrdfVersions, WhatMovesNoFrameIsListed) {
  const UrdfChain chain = parse_urdf(
      urdf({.in_joint = "<dynamics damping='1'/><gazebo/><safety_controller k_velocity='1'/><hardwareInterface>x"
                        "</hardwareInterface><calibration rising='0'/>",
            .in_robot = "<transmission name='t'><joint name='two'><hardwareInterface/></joint></transmission>"
                        "<gazebo reference='b'><pose>1 2 3 0 0 0</pose></gazebo><material name='m'/>",
            .limit = "<limit lower='-1' upper='1' effort='1' velocity='1' acceleration='2' jerk='3'/>",
            .joint = "safety='no'"}),
      "a.urdf");
  EXPECT_EQ(chain.remarks, (std::vector<std::string>{
                               "joint 'two': <safety_controller> is ignored", "joint 'two': <calibration> is ignored",
                               "joint 'two': <gazebo> is ignored", "joint 'two': <hardwareInterface> is ignored",
                               "joint 'two': its attribute 'safety' is ignored"}));
  EXPECT_LT((chain.origins[1].translation() - Vector3(0.3, 0, 0.75)).norm(), 1e-15);
  // a branch that is not of the chain
  const std::string other =
      "<link name='e'/><joint name='x' type='fixed'><parent link='a'/><child link='e'/>"
      "<origin xyz='1 0 0' scale='2'/><pose/></joint>";
  EXPECT_EQ(parse_urdf(urdf({.in_robot = other}), "a.urdf", "a", "d").robot.dof(), 2);
  EXPECT_NE(vernier_test::complaint([&] {
              (void)parse_urdf(urdf({.in_robot = other}), "a.urdf", "a", "e");
            }).find("attribute 'scale'"),
            std::string::npos);
  // geometry is not read
  const std::string capsule =
      "<link name='f'><collision><origin quat_xyzw='9 9 9 9' scale='1'/><geometry><capsule "
      "radius='0.1' length='0.2'/></geometry></collision></link><joint name='g' type='fixed'>"
      "<parent link='a'/><child link='f'/></joint>";
  EXPECT_EQ(parse_urdf(urdf({.in_robot = capsule}), "a.urdf", "a", "d").robot.dof(), 2);
}

// What is written into a file with quaternions is a quaternion.
TEST(UrdfVersions, ExportKeepsQuaternions) {
  const UrdfChain chain = parse_urdf(urdf({.origin = "quat_xyzw='0.1 -0.5 0.7 0.5' xyz='0.3 0 0.75'"}), "a.urdf");
  const ArmGeometry nominal = chain.robot.geometry();
  VectorX p = nominal.parameters();
  for (Index i = 6; i < 6 + 5 * (nominal.joints() - 1); ++i) p(i) += 1e-3 * static_cast<double>(i % 3);
  const ArmGeometry moved = nominal.with_parameters(p).with_frames(nominal.base(), nominal.tool());
  const std::string out = export_urdf(chain, moved, {});
  EXPECT_NE(out.find("quat_xyzw='"), std::string::npos) << out;
  EXPECT_EQ(out.find("rpy='0."), std::string::npos) << out;
  const UrdfChain again = parse_urdf(out, "b.urdf");
  MatrixX q(3, 2);
  q << 0.1, -0.7, 1, 0.5, -0.3, 0.9;
  const auto expected = moved.poses(q), written = again.robot.geometry().poses(q), before = nominal.poses(q);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(vernier_test::difference(written[i], expected[i]), 1e-14);
    EXPECT_GT(vernier_test::difference(before[i], expected[i]), 1e-4);
  }
}

}  // namespace
}  // namespace vernier::urdf_versions_test
