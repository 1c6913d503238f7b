// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A commanded pose and the point that belongs to it.

#include "vernier/core/types.hpp"

namespace vernier {

/// A commanded pose and the point measured there.
struct PointPair {
  Index row;    ///< of the commanded pose, from 0
  Index point;  ///< from 0

  /// Of the same row and point.
  bool operator==(const PointPair&) const = default;
};

}  // namespace vernier
