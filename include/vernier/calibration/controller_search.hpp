// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A search for the controller whose joint values make measured poses plausible, where it shows fewer joints than the
/// chain of an arm has.

#include <optional>

#include "vernier/core/controller_map.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// A controller that was found.
struct FoundController {
  ControllerMap map;  ///< from its joints to those of the chain
  double median = 0;  ///< median position error of the nominal arm in registered frames then [m]
};

/// Looks for a passive joint in an arm whose controller shows a joint less than its chain has: that of a palletiser's
/// wrist, which turns back by as much as the joints before it turn about axes parallel to its own. Each such joint is
/// tried with every pattern of signs of the other joints, and with joints that contain the one before. Base and tool
/// are registered under each, and the best patterns are fitted robustly.
/// @param nominal          the arm as designed
/// @param shown            joint values that the controller shows, n x (joints - 1) [rad, m]
/// @param positions        measured, n x 3 [m]
/// @param rotation_vectors measured orientations, n x 3; no rows where they were not measured
/// @return                 none where no such controller makes the rows plausible
/// @throws std::invalid_argument for fewer than 10 rows, or another number of columns
VERNIER_API std::optional<FoundController> find_passive_joint(const ArmGeometry& nominal, const ConstMatrixRef& shown,
                                                              const PointRows& positions,
                                                              const PointRows& rotation_vectors = PointRows(0, 3));

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/controller_search.ipp"
#endif
