// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Visits of poses, as ISO 9283 has them measured.

#include <limits>

#include "vernier/core/types.hpp"

namespace vernier {

/// One measured visit of a commanded pose.
struct Iso9283Visit {
  int pose = 1;       ///< number of the commanded pose, P1 is 1
  int cycle = 1;      ///< number of the cycle
  int direction = 0;  ///< 1, 2, 3 in a test of several directions of approach; 0 elsewhere
  /// Where the tool stood, in the frame of the commanded poses.
  Isometry3 measured = Isometry3::Identity();
  /// When that was measured [s]; NaN where unknown.
  double time_s = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace vernier
