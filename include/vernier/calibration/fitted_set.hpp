// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Measurements beside the poses, for reports.

#include <string>

#include "vernier/core/types.hpp"

namespace vernier {

/// A set of measurements that were fitted: distances, touches, or those of a sensor of a user's own.
struct FittedSet {
  std::string name;        ///< of the set
  std::string kind;        ///< of its sensor
  Index measurements = 0;  ///< their number
  double rms = 0;          ///< root mean square of what the model leaves of the lengths [m]
};

}  // namespace vernier
