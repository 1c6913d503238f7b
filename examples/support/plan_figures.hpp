// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A measurement plan in figures and words.

#include <filesystem>
#include <string>
#include <vector>

#include "vernier/planning/plan_measurements.hpp"

namespace support {

/// A plan, whatever the number of joints.
struct PlanOutcome {
  vernier::PlannedMeasurements plan{};
  vernier::RejectionCounts rejected{};       ///< of configurations that are no candidates
  vernier::MatrixX joints{}, candidates{};   ///< chosen, and to choose from [rad, m]
  vernier::PointRows points{}, reachable{};  ///< tool points of both [m]
  std::vector<vernier::JointType> types{};   ///< of the joints
  vernier::Index measured = 0;               ///< number of poses measured before
  double left_out_error = 0;                 ///< of the model of those, rms of poses left out [m]; 0: unknown
  bool oriented = false;                     ///< whether orientations are measured

  /// Expected rms position error after 0, 1, .. of the chosen poses [m]: what left-out poses show now, reduced as the
  /// plan predicts. Empty where it is unknown now.
  vernier::VectorX predicted_errors() const {
    if (left_out_error == 0) return {};
    return plan.relative_error * (left_out_error / plan.relative_error(0));
  }
};

/// The ranges of a joint (from 0) that candidates reach and the plan does not, in words; empty for none.
std::string gaps_of(const PlanOutcome& found, int joint);

/// Draws joints covered, predicted errors, and tool points from above and from the side, beside a file.
/// @param out `poses.csv` gives `poses_joints.svg`, `poses_error.svg`, `poses_top.svg`, `poses_side.svg`
/// @return their common name in words; empty where they cannot be drawn
std::string draw_plan(const std::filesystem::path& out, const PlanOutcome& found);

}  // namespace support
