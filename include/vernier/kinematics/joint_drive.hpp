// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Gears and encoders of an arm's joints, as far as they are known.

#include "vernier/core/same_value.hpp"

namespace vernier {

/// Gear and encoder of a joint. They determine at which orders (periods a turn of the joint) its errors are expected;
/// see `lines_of`.
struct JointDrive {
  double gear_ratio = 0;    ///< turns of the gear's input in a turn of the joint; 0: unknown
  int encoder_periods = 0;  ///< signal periods of the encoder in a turn of the joint; 0: unknown

  /// Equal in both.
  constexpr bool operator==(const JointDrive& other) const {
    return same_value(gear_ratio, other.gear_ratio) && encoder_periods == other.encoder_periods;
  }
};

}  // namespace vernier
