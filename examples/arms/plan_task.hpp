// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Poses to measure, whatever the number of joints.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "measured_data.hpp"
#include "vernier/planning/plan_measurements.hpp"

namespace support {

/// What to plan.
struct PlanTask {
  vernier::RobotDescription robot;            ///< the arm as designed
  vernier::Index count = 100;                 ///< poses to choose
  vernier::Index candidates = 2000;           ///< random poses to choose from
  vernier::MatrixX given{};                   ///< candidates in their place, n x joints of the controller; none: drawn
  std::optional<vernier::ToolBox> box{};      ///< where the tool may be [m]
  std::optional<vernier::Vector3> tracker{};  ///< position of a tracker that must see the tool [m]
  double acceptance = 3.141592653589793;      ///< largest angle between its beam and the tool's z axis [rad]
  double link_radius = 0;                     ///< links so thick block the beam and must not collide [m]; 0: neither
  bool oriented = false;                      ///< whether orientations are measured
  std::vector<MeasuredPoses> measured{};      ///< what was measured before
};

/// A plan, in joints of the controller.
struct PlanOutcome {
  vernier::MatrixX joints{};            ///< chosen ones in the order of choice, n x joints
  vernier::PlannedMeasurements plan{};  ///< the rest
};

/// Chooses poses.
/// @throws std::invalid_argument for unbounded limits, too few candidates, or constraints that admit hardly any pose
/// @param observer see `vernier::PlanOptions`; told of candidates before. A stop leaves an unfinished plan.
PlanOutcome plan(const PlanTask& task, std::uint64_t seed, const vernier::ObserverRef& observer = {});

}  // namespace support
