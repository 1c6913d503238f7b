// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The visits of an ISO 9283 test, sorted, and how they depart from the norm.

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vernier/evaluation/iso9283_visit.hpp"

namespace vernier::detail {

/// Visits of one pose from one direction, in sequence: by time where all times are known, else by cycle.
struct VisitedPose {
  std::vector<const Iso9283Visit*> visits;  ///< n
  PointRows positions;                      ///< n x 3 [m]
  std::vector<Matrix3> rotations;           ///< n
};

/// By pose, then by direction.
using VisitedPoses = std::map<int, std::map<int, VisitedPose>>;

/// Why this is no pose, in words; null where it is one.
VERNIER_API const char* fault_of_pose(const Isometry3& pose, bool oriented);

/// Sorts visits, which must outlive the result; refuses what `iso9283` refuses.
VERNIER_API VisitedPoses visited_poses(std::span<const Iso9283Visit> visits, std::span<const Isometry3> commanded,
                                       bool oriented);

/// Each way in which a test is not that of the norm, in words.
VERNIER_API std::vector<std::string> departures_of(std::span<const Iso9283Visit> visits, const VisitedPoses& visited,
                                                   std::span<const Isometry3> commanded, bool oriented);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/detail/iso9283_visits.ipp"
#endif
