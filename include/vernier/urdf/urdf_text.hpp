// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An arm of the catalogue or of a robot file as a plain URDF file.

#include <string>

#include "vernier/io/robot_file.hpp"

namespace vernier {

/// A URDF file of an arm: links without shape from `base_link` to `tool`, joints about their z axes, one a joint of the
/// chain, and a fixed one that holds the tool. Joint values are those of the chain, also where its controller counts
/// them otherwise. Limits are those that the controller's limits allow; a revolute joint without limits is continuous.
/// No robot file states efforts and speeds, so these limits are 0; whoever plans motions must fill them in.
/// @param robot lengths in m, angles in rad, as a URDF file has them
/// @throws std::invalid_argument for a prismatic joint without limits, which URDF does not know, or not one pair of
///         limits a joint of the controller
VERNIER_API std::string urdf_text(const RobotDescription& robot);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/urdf/urdf_text.ipp"
#endif
