// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Accuracy and repeatability of a path from repeated runs, as ISO 9283 defines them.

#include <span>
#include <string>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Settings of `iso9283_path`.
struct Iso9283PathOptions {
  int points = 10;           ///< number of points of the path that are compared
  bool orientations = true;  ///< whether orientations were measured; else all angles are NaN
};

/// Accuracy and repeatability at one point of a path [m, rad], as those of a pose in `Iso9283Pose`.
struct Iso9283PathPoint {
  double arc_length = 0;                        ///< from the beginning of the commanded path [m]
  Isometry3 commanded = Isometry3::Identity();  ///< pose of the path there
  Isometry3 mean = Isometry3::Identity();       ///< barycentre and Karcher mean of the runs
  double at = 0;                                ///< distance of the barycentre from the command
  double rt = 0;                                ///< mean distance from the barycentre plus three deviations
  Vector3 at_abc = Vector3::Zero();             ///< mean orientation with respect to the command, angles
  Vector3 rt_abc = Vector3::Zero();             ///< three standard deviations of angles
};

/// Result of `iso9283_path`: of each figure the largest absolute value of all points [m, rad].
struct Iso9283Path {
  double at = 0;                           ///< accuracy of the path (AT)
  double rt = 0;                           ///< repeatability of the path (RT); NaN for one run
  Vector3 at_abc = Vector3::Zero();        ///< AT of each angle
  Vector3 rt_abc = Vector3::Zero();        ///< RT of each angle
  double length = 0;                       ///< of the commanded path [m]
  Index runs = 0;                          ///< number of runs
  std::vector<Iso9283PathPoint> points{};  ///< in the order of the path
  /// Each way in which the data are not those of the norm, in words; empty where they are.
  std::vector<std::string> departures{};
};

/// Evaluates repeated runs along a path as ISO 9283 does: AT and RT.
///
/// The path is straight between the commanded poses, its orientation interpolated at constant rate. It is compared at
/// the middles of `points` equal parts of its length. Each pose of a run belongs to the arc length of the path's
/// nearest point, sought ahead of that of the pose before, so that a path may cross or close itself; between poses,
/// a run is interpolated over that arc length. On straight lines these are its intersections with planes across
/// the path. A run begins in the first half of a path.
/// @param commanded at least two poses in the order of the path, of which neighbours differ in position
/// @param runs      the measured poses of each run, in sequence
/// @param options   see there
/// @throws std::invalid_argument for less than two commanded poses or no runs, a run that ends before the last point or
///         begins behind the first, a pose that is not finite or no rotation, less than one point
/// @complexity O(runs x poses of a run x commanded poses)
/// @cite ISO 9283; Moakher 2002
VERNIER_API Iso9283Path iso9283_path(std::span<const Isometry3> commanded, std::span<const std::vector<Isometry3>> runs,
                                     const Iso9283PathOptions& options = {});

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/evaluation/iso9283_path.ipp"
#endif
