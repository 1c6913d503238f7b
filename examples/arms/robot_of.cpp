// SPDX-License-Identifier: BSD-3-Clause
#include "robot_of.hpp"

#include <filesystem>

#include "vernier/io/json.hpp"
#ifdef VERNIER_HAS_URDF
#include "vernier/urdf.hpp"
#endif

namespace support {

std::vector<vernier::RobotDescription> robot_catalogue() {
  using vernier::RobotDescription;
  namespace robots = vernier::robots;
  return {RobotDescription::of(robots::abb_irb120()),   RobotDescription::of(robots::ur10()),
          RobotDescription::of(robots::ur5()),          RobotDescription::of(robots::barrett_wam()),
          RobotDescription::of(robots::puma560()),      RobotDescription::of(robots::fanuc_r2000ib_165f()),
          RobotDescription::of(robots::kuka_kr6_r900())};
}

bool is_urdf(const std::string& file) { return file.ends_with(".urdf") || file.ends_with(".xacro"); }
bool is_ur_kinematics(const std::string& file) { return file.ends_with(".yaml") || file.ends_with(".yml"); }

vernier::RobotDescription robot_of_file(const std::string& file, [[maybe_unused]] const std::string& base_link,
                                        [[maybe_unused]] const std::string& tip_link,
                                        [[maybe_unused]] std::vector<std::string>& remarks) {
  if (!is_urdf(file)) {
    vernier::demand(base_link.empty() && tip_link.empty(), file, ": links are those of a URDF file (.urdf)");
    if (!is_ur_kinematics(file)) return vernier::load_robot(file);
  }
#ifdef VERNIER_HAS_URDF
  if (is_ur_kinematics(file))
    return vernier::read_ur_kinematics(file).robot(std::filesystem::path(file).stem().string());
  const vernier::UrdfChain read = vernier::read_urdf(file, base_link, tip_link);
  remarks.insert(remarks.end(), read.remarks.begin(), read.remarks.end());
  return read.robot;
#else
  throw std::invalid_argument(file + ": this build cannot read such files; it was made without tinyxml2 or yaml-cpp");
#endif
}

vernier::RobotDescription robot_of(const std::string& name_or_file, const std::string& base_link,
                                   const std::string& tip_link, std::vector<std::string>& remarks) {
  std::string known;
  for (const vernier::RobotDescription& robot : robot_catalogue()) {
    if (robot.name == name_or_file) return robot;
    known += (known.empty() ? "" : ", ") + robot.name;
  }
  std::error_code error;
  vernier::demand(name_or_file.ends_with(".json") || is_urdf(name_or_file) || is_ur_kinematics(name_or_file) ||
                      std::filesystem::exists(name_or_file, error),
                  "no robot is called '", vernier::detail::quotable(name_or_file), "'; there are ", known,
                  ", or name a file, JSON or URDF");
  return robot_of_file(name_or_file, base_link, tip_link, remarks);
}

}  // namespace support
