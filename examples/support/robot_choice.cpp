#include "robot_choice.hpp"

#include <filesystem>

#include "cli.hpp"
#include "vernier/io/json.hpp"

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

std::vector<std::string> catalogue_names() {
  std::vector<std::string> names;
  for (const auto& robot : catalogue()) names.push_back(robot.name);
  return names;
}

vernier::RobotDescription choose_robot(const std::string& name_or_file) {
  for (auto& robot : catalogue())
    if (robot.name == name_or_file) return robot;
  std::error_code error;
  if (name_or_file.ends_with(".json") || std::filesystem::exists(name_or_file, error))
    return vernier::load_robot(name_or_file);
  std::string known;
  for (const auto& name : catalogue_names()) known += (known.empty() ? "" : ", ") + name;
  throw UsageError("no robot is called '" + vernier::detail::quotable(name_or_file) + "'; there are " + known +
                   ", or name a JSON file");
}

}  // namespace support
