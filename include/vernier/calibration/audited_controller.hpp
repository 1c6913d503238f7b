#pragma once

/// @file
/// The joints of a controller that make measured poses plausible, as an audit found them.

#include <optional>

#include "vernier/calibration/data_audit.hpp"
#include "vernier/core/controller_map.hpp"

namespace vernier {

/// The map with which the faults of an audit in signs and couplings of joints vanish; none where it found no such
/// fault.
/// @param audit        of poses whose joints were read by `controller`
/// @param controller   the map of before
/// @param chain_joints number of joints of the chain
/// @throws std::invalid_argument for a map of another number of joints
VERNIER_API std::optional<ControllerMap> audited_controller(const DataAudit& audit, const ControllerMap& controller,
                                                            int chain_joints);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/audited_controller.ipp"
#endif
