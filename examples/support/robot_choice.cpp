// SPDX-License-Identifier: BSD-3-Clause
#include "robot_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "robot_of.hpp"
#include "vernier/io/json.hpp"
#include "vernier/io/ur_calibration.hpp"
#ifdef VERNIER_HAS_URDF
#include "vernier/urdf.hpp"
#endif

namespace support {

Option RobotOptions::add_to(Program& program) {
  std::string names;
  for (const auto& name : catalogue_names()) names += (names.empty() ? "" : ", ") + name;
  Option out =
      program.add_option("--robot", robot,
                         "name in the catalogue (" + names +
                             "), or a file: JSON, URDF (.urdf), kinematics of Universal Robots' driver (.yaml)",
                         "NAME|FILE");
  out.offers(catalogue_names());
  program.add_option("--base-link", base_link, "of a URDF file: where the arm begins; by default the root", "LINK")
      .needs(out);
  program
      .add_option("--tip-link", tip_link,
                  "of a URDF file: where the arm ends; by default the only link without a child", "LINK")
      .needs(out);
  program
      .add_option("--ur-calibration", ur_calibration,
                  "factory calibration of an arm of Universal Robots, the controller's calibration.conf: the arm as it "
                  "was made, not as designed",
                  "FILE")
      .needs(out);
  program
      .add_option(
          "--controller-joints", controller_joints,
          "how each joint of the arm's table follows from the controller's joints: J1,J2,-J2-J3,-J4,-J5,-J6 of a "
          "FANUC arm; a robot file has them in its key controller",
          "FORMULAS")
      .delimiter(',')
      .needs(out);
  program.add_option("--down", down, "direction of gravity in the arm's base frame; by default -z", "X,Y,Z")
      .delimiter(',')
      .expected(3)
      .needs(out);
  return out;
}

bool RobotOptions::is_urdf() const { return support::is_urdf(robot); }

namespace {

/// Limits of controller joints that are each one row's, turned and shifted; infinite of others.
void take_controller(const std::vector<std::string>& formulas, vernier::RobotDescription& robot) {
  if (!robot.controller.same())
    throw UsageError("--controller-joints: " + robot.name + " states the joints of its controller itself");
  try {
    robot.controller = vernier::ControllerMap(formulas, robot.joint_types());
    static_cast<void>(robot.controller.joints(robot.dof()));
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--controller-joints: {}", error.what()));
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto joints = static_cast<std::size_t>(robot.controller_joints());
  std::vector<std::pair<double, double>> limits(joints, {-infinity, infinity});
  const vernier::MatrixX& inverse = robot.controller.inverse();
  for (vernier::Index j = 0; j < static_cast<vernier::Index>(joints); ++j) {
    vernier::Index row = -1, terms = 0;
    for (vernier::Index i = 0; i < inverse.cols(); ++i)
      if (inverse(j, i) != 0) {
        row = i;
        ++terms;
      }
    auto [lower, upper] = robot.limits[static_cast<std::size_t>(row)];
    const double factor = inverse(j, row), zero = robot.controller.zeros()(row);
    if (terms == 1)
      limits[static_cast<std::size_t>(j)] = {factor * ((factor > 0 ? lower : upper) - zero),
                                             factor * ((factor > 0 ? upper : lower) - zero)};
    else if (std::isfinite(lower) || std::isfinite(upper))
      fmt::print("Controller joint {} moves with others; its limits are unknown, a robot file can state them\n", j + 1);
  }
  robot.limits = limits;
}

vernier::RobotDescription arm_of(const RobotOptions& options, [[maybe_unused]] vernier::UrdfChain* chain) {
  if (!options.is_urdf() && !(options.base_link.empty() && options.tip_link.empty()))
    throw UsageError("--base-link and --tip-link are of a URDF file (.urdf) of --robot");
  const bool yaml = is_ur_kinematics(options.robot);
  if (!options.ur_calibration.empty() && (options.is_urdf() || yaml))
    throw UsageError(
        "--ur-calibration is for arms of the catalogue or of a JSON file; a URDF file has joint frames of "
        "its own");
  if (options.is_urdf() || yaml) {
#ifdef VERNIER_HAS_URDF
    if (yaml)
      return vernier::read_ur_kinematics(options.robot).robot(std::filesystem::path(options.robot).stem().string());
    const vernier::UrdfChain read = vernier::read_urdf(options.robot, options.base_link, options.tip_link);
    for (const std::string& remark : read.remarks) fmt::print("{}: {}\n", options.robot, remark);
    if (chain != nullptr) *chain = read;
    return read.robot;
#else
    throw UsageError(options.robot + ": this build cannot read such files; it was made without tinyxml2 or yaml-cpp");
#endif
  }
  const vernier::RobotDescription out = choose_robot(options.robot);
  return options.ur_calibration.empty() ? out : vernier::read_ur_calibration(options.ur_calibration, out);
}

}  // namespace

vernier::RobotDescription choose_robot(const RobotOptions& options, vernier::UrdfChain* chain) {
  vernier::RobotDescription out = arm_of(options, chain);
  if (!options.controller_joints.empty()) take_controller(options.controller_joints, out);
  if (!options.down.empty()) {
    const vernier::Vector3 down(options.down[0], options.down[1], options.down[2]);
    if (!(down.norm() > 1e-3 && down.allFinite())) throw UsageError("--down has no direction");
    out.down = down.normalized();
    out.down_stated = true;
  }
  // rows of the modified convention may turn the rail before it slides
  if (!out.down_stated && !out.modified && out.rows.front().joint == vernier::JointType::prismatic)
    fmt::print(
        "{}: gravity is taken to act along joint 1, which slides; if it is a rail, state the direction by --down or by "
        "\"down\" in the robot file\n",
        out.name);
  return out;
}

std::vector<std::string> catalogue_names() {
  std::vector<std::string> names;
  for (const auto& robot : robot_catalogue()) names.push_back(robot.name);
  return names;
}

vernier::RobotDescription choose_robot(const std::string& name_or_file) {
  std::vector<std::string> remarks;
  const auto known = catalogue_names();
  std::error_code error;
  if (std::find(known.begin(), known.end(), name_or_file) == known.end() && !name_or_file.ends_with(".json") &&
      !is_urdf(name_or_file) && !is_ur_kinematics(name_or_file) && !std::filesystem::exists(name_or_file, error)) {
    std::string names;
    for (const auto& name : known) names += (names.empty() ? "" : ", ") + name;
    throw UsageError("no robot is called '" + vernier::detail::quotable(name_or_file) + "'; there are " + names +
                     ", or name a file, JSON or URDF");
  }
  const vernier::RobotDescription out = robot_of(name_or_file, "", "", remarks);
  for (const std::string& remark : remarks) fmt::print("{}: {}\n", name_or_file, remark);
  return out;
}

}  // namespace support
