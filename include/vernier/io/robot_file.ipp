// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/io/json.hpp"
#include "vernier/io/robot_file.hpp"

namespace vernier {

namespace detail {

/// Limits `lower` and `upper` of a joint; infinite where they are missing.
VERNIER_LOCAL std::pair<double, double> read_limits(const JsonNode& joint, bool revolute) {
  std::pair<double, double> out{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  if (joint.has_quantity("lower")) out.first = revolute ? joint.angle("lower") : joint.length("lower");
  if (joint.has_quantity("upper")) out.second = revolute ? joint.angle("upper") : joint.length("upper");
  if (!(out.first < out.second))
    joint.fail(message("lower limit ", out.first, " is not below upper limit ", out.second));
  return out;
}

/// Gear and encoder of a joint.
VERNIER_LOCAL JointDrive read_drive(const JsonNode& joint, bool revolute) {
  JointDrive drive;
  if (joint.has("gear_ratio")) {
    drive.gear_ratio = joint.at("gear_ratio").number();
    if (!(drive.gear_ratio >= 1)) joint.at("gear_ratio").fail("must be at least 1");
  }
  if (joint.has("encoder_periods"))
    drive.encoder_periods = static_cast<int>(joint.at("encoder_periods").integer(1, 100000));
  if (!revolute && drive != JointDrive{}) joint.fail("gear_ratio and encoder_periods are those of a revolute joint");
  return drive;
}

/// One joint of a robot file.
VERNIER_LOCAL void read_joint(const JsonNode& joint, RobotDescription& robot) {
  joint.allow_only({"type",      "a_mm",      "a_m",       "alpha_deg", "alpha_rad", "d_mm",       "d_m",
                    "theta_deg", "theta_rad", "beta_deg",  "beta_rad",  "lower_deg", "lower_rad",  "lower_mm",
                    "lower_m",   "upper_deg", "upper_rad", "upper_mm",  "upper_m",   "gear_ratio", "encoder_periods"});
  DhRow row;
  const std::string type = joint.has("type") ? joint.at("type").text() : "revolute";
  if (type != "revolute" && type != "prismatic")
    joint.at("type").fail("'" + quotable(type) + "' is neither revolute nor prismatic");
  row.joint = type == "revolute" ? JointType::revolute : JointType::prismatic;
  row.a = joint.length("a");
  row.alpha = joint.angle("alpha");
  row.d = joint.length("d");
  row.theta = joint.angle("theta");
  if (joint.has_quantity("beta")) row.beta = joint.angle("beta");
  constexpr double largest_length = 100, largest_angle = 100;
  for (const double length : {row.a, row.d})
    if (std::abs(length) > largest_length) joint.fail(message("a length of ", length, " m; is the unit right?"));
  for (const double angle : {row.alpha, row.theta, row.beta})
    if (std::abs(angle) > largest_angle) joint.fail(message("an angle of ", angle, " rad; is the unit right?"));
  const bool revolute = row.joint == JointType::revolute;
  const std::pair<double, double> bounds = read_limits(joint, revolute);
  robot.drives.push_back(read_drive(joint, revolute));
  robot.rows.push_back(row);
  robot.limits.push_back(bounds);
}

/// The keys `errors` and `drives` of a controller: where gears err, and gears and encoders of its joints.
VERNIER_LOCAL void read_motors(const JsonNode& controller, const std::vector<JointType>& types,
                               RobotDescription& robot) {
  const std::string errors = controller.has("errors") ? controller.at("errors").text() : "chain";
  if (errors != "chain" && errors != "motors")
    controller.at("errors").fail("'" + quotable(errors) + "' is neither chain nor motors");
  const bool of_motors = errors == "motors";
  robot.controller = robot.controller.with_motor_errors(of_motors);
  if (!of_motors) {
    if (controller.has("drives"))
      controller.at("drives").fail("needs errors: motors; else drives are those of the rows");
    return;
  }
  for (const JointDrive& drive : robot.drives)
    if (drive != JointDrive{})
      controller.at("errors").fail("a row has gear_ratio or encoder_periods; those of motors are in controller.drives");
  if (!controller.has("drives")) return;
  const JsonNode drives = controller.at("drives");
  drives.require_size(types.size());
  for (std::size_t j = 0; j < types.size(); ++j) {
    drives.at(j).allow_only({"gear_ratio", "encoder_periods"});
    robot.drives[j] = read_drive(drives.at(j), types[j] == JointType::revolute);
  }
}

/// The key `controller`: formulas of the chain's joints, limits, and where gears err.
VERNIER_LOCAL void read_controller(const JsonNode& controller, const JsonNode& joints, RobotDescription& robot) {
  controller.allow_only({"chain", "limits", "errors", "drives"});
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints.at(i).has_quantity("lower") || joints.at(i).has_quantity("upper"))
      joints.at(i).fail("limits are those of the controller's joints, in controller.limits");
  const JsonNode chain = controller.at("chain");
  chain.require_size(robot.rows.size());
  std::vector<std::string> formulas;
  for (std::size_t i = 0; i < chain.size(); ++i) formulas.push_back(chain.at(i).text(200));
  const std::vector<JointType> chain_types = robot.joint_types();
  try {
    robot.controller = ControllerMap(formulas, chain_types);
  } catch (const std::invalid_argument& error) {
    chain.fail(error.what());
  }
  const std::vector<JointType> types = robot.controller.types(chain_types);
  read_motors(controller, types, robot);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  robot.limits.assign(types.size(), {-infinity, infinity});
  if (!controller.has("limits")) return;
  const JsonNode limits = controller.at("limits");
  limits.require_size(types.size());
  for (std::size_t j = 0; j < types.size(); ++j) {
    const bool revolute = types[j] == JointType::revolute;
    if (revolute)
      limits.at(j).allow_only({"lower_deg", "lower_rad", "upper_deg", "upper_rad"});
    else
      limits.at(j).allow_only({"lower_mm", "lower_m", "upper_mm", "upper_m"});
    robot.limits[j] = read_limits(limits.at(j), revolute);
  }
}

/// A frame: position, rotation vector or quaternion.
/// @param known whether it is stated as known
VERNIER_LOCAL Isometry3 read_frame(const JsonNode& frame, bool& known) {
  frame.allow_only({"x_mm", "x_m", "y_mm", "y_m", "z_mm", "z_m", "rx_deg", "rx_rad", "ry_deg", "ry_rad", "rz_deg",
                    "rz_rad", "qw", "qx", "qy", "qz", "known", "comment"});
  Vector3 position = Vector3::Zero(), turn = Vector3::Zero();
  int given = 0;
  bool turned = false;
  for (int k = 0; k < 3; ++k) {
    const std::string axis(1, "xyz"[k]);
    if (frame.has_quantity(axis)) {
      position(k) = frame.length(axis);
      ++given;
    }
    if (frame.has_quantity("r" + axis)) {
      turn(k) = frame.angle("r" + axis);
      turned = true;
    }
  }
  if (given != 0 && given != 3) frame.fail("a position has x, y and z");
  Matrix3 orientation = exp_so3(turn);
  if (frame.has("qw") || frame.has("qx") || frame.has("qy") || frame.has("qz")) {
    if (turned) frame.fail("a rotation vector and a quaternion both give its orientation");
    Vector3 imaginary(frame.at("qx").number(), frame.at("qy").number(), frame.at("qz").number());
    double real = frame.at("qw").number();
    const double norm = std::hypot(real, imaginary.norm());
    if (!(std::abs(norm - 1) < 1e-3)) frame.fail(message("the quaternion has the norm ", norm, ", must be 1"));
    if (real < 0) {
      real = -real;
      imaginary = -imaginary;
    }
    const double sine = imaginary.norm();
    const Vector3 axis = sine > 0 ? Vector3(imaginary / sine) : Vector3(0, 0, 1);
    orientation = exp_so3(Vector3(2 * std::atan2(sine, real) * axis));
  }
  known = frame.has("known") && frame.at("known").boolean();
  return rigid_motion(orientation, position);
}

}  // namespace detail

VERNIER_IMPL ArmGeometry RobotDescription::geometry() const {
  const detail::ChainTable chain(rows, modified);
  const ArmGeometry inner = modified ? detail::to_standard(chain) : ArmGeometry(chain, {}, {});
  return inner.with_frames(composed(base, inner.base().isometry()), tool);
}

VERNIER_IMPL Vector3 RobotDescription::chain_down() const {
  if (!modified) return down;
  const Matrix3 turn = rotation(detail::to_standard(detail::ChainTable(rows, true)).base().isometry());
  return turn.transpose() * down;
}

VERNIER_IMPL RobotDescription load_robot(const std::string& path) {
  const std::string content = detail::read_json_text(path);
  const nlohmann::json document = parse_json(content, path);
  const JsonNode root(document, path);
  root.allow_only({"name", "convention", "joints", "controller", "base", "tool", "down", "comment"});
  RobotDescription out;
  out.files.push_back({path, sha256(content)});
  out.name = root.at("name").text();
  const std::string convention = root.at("convention").text();
  if (convention != "standard" && convention != "modified")
    root.at("convention").fail("'" + detail::quotable(convention) + "' is neither standard nor modified");
  out.modified = convention == "modified";
  const JsonNode joints = root.at("joints");
  if (joints.size() < 1 || joints.size() > max_arm_joints)
    joints.fail(message("has ", joints.size(), " joints, must have 1 to ", max_arm_joints));
  for (std::size_t i = 0; i < joints.size(); ++i) detail::read_joint(joints.at(i), out);
  if (root.has("controller")) detail::read_controller(root.at("controller"), joints, out);
  if (root.has("base")) out.base = detail::read_frame(root.at("base"), out.base_known);
  if (root.has("tool")) out.tool = detail::read_frame(root.at("tool"), out.tool_known);
  if (root.has("down")) {
    const VectorX down = root.at("down").numbers(3);
    const double length = down.norm();
    if (!(length > 1e-3)) root.at("down").fail("has no direction");
    out.down = Vector3(down(0), down(1), down(2)) / length;
    out.down_stated = true;
  }
  return out;
}

}  // namespace vernier
