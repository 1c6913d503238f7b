#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/io/json.hpp"
#include "vernier/io/robot_file.hpp"

namespace vernier {

namespace detail {

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
  std::pair<double, double> bounds{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const bool revolute = row.joint == JointType::revolute;
  if (joint.has_quantity("lower")) bounds.first = revolute ? joint.angle("lower") : joint.length("lower");
  if (joint.has_quantity("upper")) bounds.second = revolute ? joint.angle("upper") : joint.length("upper");
  if (!(bounds.first < bounds.second))
    joint.fail(message("lower limit ", bounds.first, " is not below upper limit ", bounds.second));
  JointDrive drive;
  if (joint.has("gear_ratio")) {
    drive.gear_ratio = joint.at("gear_ratio").number();
    if (!(drive.gear_ratio >= 1)) joint.at("gear_ratio").fail("must be at least 1");
  }
  if (joint.has("encoder_periods"))
    drive.encoder_periods = static_cast<int>(joint.at("encoder_periods").integer(1, 100000));
  if (!revolute && drive != JointDrive{}) joint.fail("gear_ratio and encoder_periods are those of a revolute joint");
  robot.drives.push_back(drive);
  robot.rows.push_back(row);
  robot.limits.push_back(bounds);
}

}  // namespace detail

VERNIER_IMPL ArmGeometry RobotDescription::geometry() const {
  const detail::ChainTable chain(rows, modified);
  const ArmGeometry inner = modified ? detail::to_standard(chain) : ArmGeometry(chain, {}, {});
  return inner.with_frames(composed(base, inner.base().isometry()), tool);
}

VERNIER_IMPL RobotDescription load_robot(const std::string& path) {
  const std::string content = detail::read_json_text(path);
  const nlohmann::json document = parse_json(content, path);
  const JsonNode root(document, path);
  root.allow_only({"name", "convention", "joints", "comment"});
  RobotDescription out;
  out.files.push_back({path, sha256(content)});
  out.name = root.at("name").text();
  const std::string convention = root.at("convention").text();
  if (convention != "standard" && convention != "modified")
    root.at("convention").fail("'" + detail::quotable(convention) + "' is neither standard nor modified");
  out.modified = convention == "modified";
  const JsonNode joints = root.at("joints");
  if (joints.size() < 3 || joints.size() > max_arm_joints)
    joints.fail(message("has ", joints.size(), " joints, must have 3 to ", max_arm_joints));
  for (std::size_t i = 0; i < joints.size(); ++i) detail::read_joint(joints.at(i), out);
  return out;
}

}  // namespace vernier
