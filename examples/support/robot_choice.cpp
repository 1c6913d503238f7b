#include "robot_choice.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "vernier/io/json.hpp"
#include "vernier/io/ur_calibration.hpp"
#ifdef VERNIER_HAS_URDF
#include "vernier/urdf.hpp"
#endif

namespace support {

namespace {

std::vector<vernier::RobotDescription> catalogue() {
  using vernier::RobotDescription;
  namespace robots = vernier::robots;
  return {RobotDescription::of(robots::abb_irb120()), RobotDescription::of(robots::ur10()),
          RobotDescription::of(robots::ur5()), RobotDescription::of(robots::barrett_wam()),
          RobotDescription::of(robots::puma560())};
}

}  // namespace

Option RobotOptions::add_to(Program& program) {
  std::string names;
  for (const auto& name : catalogue_names()) names += (names.empty() ? "" : ", ") + name;
  const Option out =
      program.add_option("--robot", robot,
                         "name in the catalogue (" + names +
                             "), or a file: JSON, URDF (.urdf), kinematics of Universal Robots' driver (.yaml)",
                         "NAME|FILE");
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
  return out;
}

bool RobotOptions::is_urdf() const { return robot.ends_with(".urdf") || robot.ends_with(".xacro"); }

vernier::RobotDescription choose_robot(const RobotOptions& options, [[maybe_unused]] vernier::UrdfChain* chain) {
  if (!options.is_urdf() && !(options.base_link.empty() && options.tip_link.empty()))
    throw UsageError("--base-link and --tip-link are of a URDF file (.urdf) of --robot");
  const bool yaml = options.robot.ends_with(".yaml") || options.robot.ends_with(".yml");
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

std::vector<std::string> catalogue_names() {
  std::vector<std::string> names;
  for (const auto& robot : catalogue()) names.push_back(robot.name);
  return names;
}

vernier::RobotDescription choose_robot(const std::string& name_or_file) {
  for (auto& robot : catalogue())
    if (robot.name == name_or_file) return robot;
  if (const RobotOptions alone{name_or_file, {}, {}, {}};
      alone.is_urdf() || name_or_file.ends_with(".yaml") || name_or_file.ends_with(".yml"))
    return choose_robot(alone);
  std::error_code error;
  if (name_or_file.ends_with(".json") || std::filesystem::exists(name_or_file, error))
    return vernier::load_robot(name_or_file);
  std::string known;
  for (const auto& name : catalogue_names()) known += (known.empty() ? "" : ", ") + name;
  throw UsageError("no robot is called '" + vernier::detail::quotable(name_or_file) + "'; there are " + known +
                   ", or name a file, JSON or URDF");
}

}  // namespace support
