// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `vernier.Robot`: an arm as designed.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nominal_arm.hpp"
#include "vernier/io/robot_file.hpp"

namespace python {

/// An arm as designed, and the code for its number of joints.
struct Robot {
  explicit Robot(vernier::RobotDescription description, std::vector<std::string> said = {})
      : about(std::move(description)), arm(support::nominal_arm(about)), remarks(std::move(said)) {}

  vernier::RobotDescription about;                 ///< as it was described
  std::shared_ptr<const support::NominalArm> arm;  ///< its kinematics
  std::vector<std::string> remarks;                ///< what was ignored in its file
};

}  // namespace python
