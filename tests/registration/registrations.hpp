// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Frames and options of re-registrations.

#include <limits>
#include <string>

#include "vernier/registration/reregister.hpp"

namespace vernier_test {

/// @param values x, y, z [m] and a rotation vector [rad]
inline vernier::Isometry3 frame(const vernier::Vector6& values) { return vernier::FrameParameters(values).isometry(); }

/// A tool of which nothing is known.
inline vernier::ReregisterOptions another_tool(vernier::ReregisterOptions options = {}) {
  options.tool = true;
  options.tool_position_prior_std = options.tool_rotation_prior_std = std::numeric_limits<double>::infinity();
  return options;
}

inline bool mentions(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace vernier_test
