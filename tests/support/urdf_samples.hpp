// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// URDF files for tests: three arms as one meets them, and random trees.

#include <string>
#include <vector>

#include "random_chains.hpp"
#include "vernier/core/check.hpp"
#include "vernier/core/rng.hpp"

namespace vernier_test {

/// Like Universal Robots' UR10, in their description's frames: axes about z, half a turn before the first joint, a
/// controller's base and a flange as branches, numbers in ten digits.
inline const std::string& ur_like_urdf() {
  static const std::string text = R"(<?xml version="1.0" ?>
<!-- an arm with <origin> in a comment -->
<robot name="ur_like">
  <link name="base_link"/>
  <link name="base_link_inertia">
    <visual>
      <origin xyz="0 0 0" rpy="0 0 3.141592653589793"/>
      <geometry><mesh filename="package://arm/base.dae"/></geometry>
    </visual>
  </link>
  <link name="shoulder_link"/>
  <link name="upper_arm_link"/>
  <link name="forearm_link"/>
  <link name="wrist_1_link"/>
  <link name="wrist_2_link"/>
  <link name="wrist_3_link"/>
  <joint name="base_link-base_link_inertia" type="fixed">
    <parent link="base_link"/>
    <child link="base_link_inertia"/>
    <origin rpy="0 0 3.141592653589793" xyz="0 0 0"/>
  </joint>
  <joint name="shoulder_pan_joint" type="revolute">
    <parent link="base_link_inertia"/>
    <child link="shoulder_link"/>
    <origin rpy="0 0 0" xyz="0 0 0.1273"/>
    <axis xyz="0 0 1"/>
    <limit effort="330.0" lower="-6.283185307179586" upper="6.283185307179586" velocity="2.0943951023931953"/>
    <dynamics damping="0" friction="0"/>
    <safety_controller k_position="20" k_velocity="0.0" soft_lower_limit="-6.1" soft_upper_limit="6.1"/>
  </joint>
  <joint name="shoulder_lift_joint" type="revolute">
    <parent link="shoulder_link"/>
    <child link="upper_arm_link"/>
    <origin rpy="1.570796327 0 0" xyz="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit effort="330.0" lower="-6.283185307179586" upper="6.283185307179586" velocity="2.09"/>
  </joint>
  <joint name="elbow_joint" type="revolute">
    <parent link="upper_arm_link"/>
    <child link="forearm_link"/>
    <origin rpy="0 0 0" xyz="-0.612 0 0"/>
    <axis xyz="0 0 1"/>
    <limit effort="150.0" lower="-3.141592653589793" upper="3.141592653589793" velocity="3.14"/>
  </joint>
  <joint name="wrist_1_joint" type="revolute">
    <parent link="forearm_link"/>
    <child link="wrist_1_link"/>
    <origin rpy="0 0 0" xyz="-0.5723 0 0.163941"/>
    <axis xyz="0 0 1"/>
    <limit effort="56.0" lower="-6.28" upper="6.28" velocity="3.14"/>
  </joint>
  <joint name="wrist_2_joint" type="revolute">
    <parent link="wrist_1_link"/>
    <child link="wrist_2_link"/>
    <origin rpy="1.570796327 0 0" xyz="0 -0.1157 -2.373046667922381e-11"/>
    <axis xyz="0 0 1"/>
    <limit effort="56.0" lower="-6.28" upper="6.28" velocity="3.14"/>
  </joint>
  <joint name="wrist_3_joint" type="revolute">
    <parent link="wrist_2_link"/>
    <child link="wrist_3_link"/>
    <origin rpy="1.570796326589793 3.141592653589793 3.141592653589793" xyz="0 0.0922 -1.891053610911353e-11"/>
    <axis xyz="0 0 1"/>
    <limit effort="56.0" lower="-6.28" upper="6.28" velocity="3.14"/>
  </joint>
  <link name="base"/>
  <joint name="base_link-base_fixed_joint" type="fixed">
    <origin rpy="0 0 3.141592653589793" xyz="0 0 0"/>
    <parent link="base_link"/>
    <child link="base"/>
  </joint>
  <link name="flange"/>
  <joint name="wrist_3-flange" type="fixed">
    <parent link="wrist_3_link"/>
    <child link="flange"/>
    <origin rpy="0 -1.5707963267948966 -1.5707963267948966" xyz="0 0 0"/>
  </joint>
  <link name="tool0"/>
  <joint name="flange-tool0" type="fixed">
    <origin rpy="1.5707963267948966 0 1.5707963267948966" xyz="0 0 0"/>
    <parent link="flange"/>
    <child link="tool0"/>
  </joint>
</robot>
)";
  return text;
}

/// Like an IRB 120: axes about x, y and z of upright frames, a sensor's fixed joint inside of the chain, a gripper with
/// a mimicking finger as a branch; single quotes, tabs, Windows line ends, an origin without rpy, one without anything,
/// and joints in front of their links.
inline const std::string& abb_like_urdf() {
  static const std::string text =
      "<robot name='abb_like'>\r\n"
      "\t<joint name='joint_1' type='revolute'><origin xyz='0 0 0'/><parent link='base_link'/><child link='link_1'/>"
      "<axis xyz='0 0 1'/><limit effort='0' lower='-2.87979' upper='2.87979' velocity='4.36332'/></joint>\r\n"
      "\t<joint name='joint_2' type='revolute'><parent link='link_1'/><child link='link_2'/>"
      "<origin  rpy='0 0 0'\r\n\t\txyz='0 0 0.29' /><axis xyz='0 1 0'/>"
      "<limit effort='0' lower='-1.91986' upper='1.91986' velocity='4.36332'/></joint>\r\n"
      "\t<joint name='joint_3' type='revolute'><origin xyz='0 0 0.27'></origin><parent link='link_2'/>"
      "<child link='link_3'/><axis xyz='0 1 0'/><limit effort='0' lower='-1.91986' upper='1.22173' "
      "velocity='4.36332'/><calibration rising='0.1'/></joint>\r\n"
      "\t<joint name='sensor_plate' type='fixed'><origin xyz='0.01 0 0.02' rpy='0 0 0.3'/><parent link='link_3'/>"
      "<child link='plate'/></joint>\r\n"
      "\t<joint name='joint_4' type='revolute'><origin xyz='0.13374710847758484 -0.041372828932587537 0.05' rpy='0 0 "
      "-0.3'/><parent link='plate'/>"
      "<child link='link_4'/><axis xyz='1 0 0'/><limit effort='0' lower='-2.79253' upper='2.79253' "
      "velocity='5.58505'/></joint>\r\n"
      "\t<joint name='joint_5' type='revolute'><origin xyz='0.152 0 0'/><parent link='link_4'/><child link='link_5'/>"
      "<axis xyz='0 1 0'/><limit effort='0' lower='-2.0944' upper='2.0944' velocity='5.58505'/></joint>\r\n"
      "\t<joint name='joint_6' type='continuous'>\r\n\t\t<parent link='link_5'/><child link='link_6'/>"
      "<axis xyz='1 0 0'/></joint>\r\n"
      "\t<joint name='link_6-tool0' type='fixed'><origin xyz='0.072 0 0' rpy='0 1.5707963267949 0'/>"
      "<parent link='link_6'/><child link='tool0'/></joint>\r\n"
      "\t<joint name='gripper' type='fixed'><parent link='tool0'/><child link='palm'/></joint>\r\n"
      "\t<joint name='left' type='prismatic'><parent link='palm'/><child link='left_finger'/><axis xyz='0 1 0'/>"
      "<limit effort='1' lower='0' upper='0.02' velocity='1'/></joint>\r\n"
      "\t<joint name='right' type='prismatic'><parent link='palm'/><child link='right_finger'/><axis xyz='0 1 0'/>"
      "<limit effort='1' lower='0' upper='0.02' velocity='1'/><mimic joint='left' multiplier='-1'/></joint>\r\n"
      "\t<link name='base_link'/><link name='link_1'/><link name='link_2'/><link name='link_3'/><link name='plate'/>"
      "<link name='link_4'/><link name='link_5'/><link name='link_6'/><link name='tool0'/><link name='palm'/>"
      "<link name='left_finger'/><link name='right_finger'/>\r\n"
      "</robot>\r\n";
  return text;
}

/// Seven axes, each frame turned by a quarter to the one before, one axis upside down.
inline const std::string& seven_axis_urdf() {
  static const std::string text = [] {
    const char* origins[7] = {"xyz=\"0 0 0.1575\" rpy=\"0 0 0\"",
                              "xyz=\"0 0 0.2025\" rpy=\"1.570796326794897 0 3.141592653589793\"",
                              "xyz=\"0 0.2045 0\" rpy=\"1.570796326794897 0 3.141592653589793\"",
                              "xyz=\"0 0 0.2155\" rpy=\"1.570796326794897 0 0\"",
                              "xyz=\"0 0.1845 0\" rpy=\"-1.570796326794897 3.141592653589793 0\"",
                              "xyz=\"0 0 0.2155\" rpy=\"1.570796326794897 0 0\"",
                              "xyz=\"0 0.081 0\" rpy=\"-1.570796326794897 3.141592653589793 0\""};
    std::string out = "<?xml version='1.0' encoding='utf-8'?>\n<robot name=\"seven\">\n  <link name=\"link_0\"/>\n";
    for (int i = 0; i < 7; ++i)
      out += vernier::message("  <link name=\"link_", i + 1, "\"/>\n  <joint name=\"joint_a", i + 1,
                              "\" type=\"revolute\">\n    <parent link=\"link_", i, "\"/>\n    <child link=\"link_",
                              i + 1, "\"/>\n    <origin ", origins[i], "/>\n    <axis xyz=\"0 0 ", i == 4 ? -1 : 1,
                              "\"/>\n    <limit lower=\"-2.9\" upper=\"2.9\" effort=\"300\" velocity=\"10\"/>\n"
                              "  </joint>\n");
    return out + "</robot>\n";
  }();
  return text;
}

/// A random tree: a chain of `moving` joints of which some are nearly parallel, upside down or prismatic, with fixed
/// joints and branches, from link "base" to link "tip".
inline std::string random_tree_urdf(vernier::Rng& rng, int moving) {
  const auto three = [&](double size) {
    return vernier::message(rng.uniform(-size, size), " ", rng.uniform(-size, size), " ", rng.uniform(-size, size));
  };
  std::string out = "<robot name=\"random\"><link name=\"base\"/>";
  std::string link = "base";
  int count = 0;
  const auto add = [&](const std::string& type, const std::string& child, const std::string& rpy,
                       const std::string& inside) {
    out += "<link name=\"" + child + "\"/>\n<joint name=\"j" + std::to_string(count++) + "\" type=\"" + type +
           "\"><parent link=\"" + link + "\"/><child link=\"" + child + "\"/><origin xyz=\"" + three(0.5) +
           "\" rpy=\"" + rpy + "\"/>" + inside + "</joint>";
  };
  for (int i = 0; i < moving; ++i) {
    if (rng.uniform() < 0.3) {
      const std::string child = "fixed" + std::to_string(i);
      add("fixed", child, three(3), "");
      link = child;
    }
    if (rng.uniform() < 0.3) add("continuous", "branch" + std::to_string(i), three(3), "<axis xyz=\"0 0 1\"/>");
    const double kind = rng.uniform();
    std::string axis = vernier::message("<axis xyz=\"", three(1), "\"/>"), rpy = three(3);
    if (kind < 0.4) {
      axis = kind < 0.1 ? "<axis xyz=\"0 0 -1\"/>" : "<axis xyz=\"0 0 1\"/>";
      rpy = kind < 0.15 ? "0 0 0" : three(kind < 0.25 ? 1e-3 : kind < 0.32 ? 1e-9 : 0.14);
    } else if (kind < 0.45) {
      axis = "";
    }
    const std::string child = "link" + std::to_string(i);
    add(rng.uniform() < 0.2 ? "prismatic" : "revolute", child, rpy,
        axis + "<limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/>");
    link = child;
  }
  add("fixed", "tip", three(3), "");
  return out + "</robot>\n";
}

}  // namespace vernier_test
