// SPDX-License-Identifier: BSD-3-Clause
#include "known_parts.hpp"

#include "vernier/identification/commanded_parameters.hpp"

namespace support {

std::string hold_known_parts(const vernier::RobotDescription& arm, vernier::CalibrateOptions& options) {
  using vernier::Frames;
  if (arm.base_known || arm.tool_known)
    options.geometry.frames = arm.base_known && arm.tool_known ? Frames::none
                              : arm.base_known                 ? Frames::tool
                                                               : Frames::base;
  std::string held;
  for (const std::string& name : vernier::unseen_parameters(arm.geometry(), arm.controller, options.geometry)) {
    options.geometry.fixed.push_back(name);
    held += (held.empty() ? "" : ", ") + name;
  }
  return held;
}

}  // namespace support
