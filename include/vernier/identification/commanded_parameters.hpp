// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Parameters of an arm that no command of its controller tells apart.

#include <string>
#include <vector>

#include "vernier/core/controller_map.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// Names of the parameters that no command can tell from others, because a passive joint follows them: those of a
/// palletiser's wrist, for instance. Parameters of the base come first, then those of the tool, then those of the
/// chain; a parameter that depends on those before it is named. Held (`IdentifyOptions::fixed`), it changes no pose
/// that the controller can command. None are named where the controller has as many joints as the chain.
/// @param nominal    the arm
/// @param controller how its joints follow from those of the controller
/// @param options    which parameters would be identified
/// @throws std::invalid_argument for a map of another number of joints
/// @cite Khalil and Gautier 1991
VERNIER_API std::vector<std::string> unseen_parameters(const ArmGeometry& nominal, const ControllerMap& controller,
                                                       const IdentifyOptions& options);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/commanded_parameters.ipp"
#endif
