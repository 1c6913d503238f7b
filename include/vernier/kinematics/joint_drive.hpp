#pragma once

/// @file
/// Gears and encoders of an arm's joints, as far as they are known.

#include "vernier/core/language.hpp"

namespace vernier {

/// Gear and encoder of a joint. They determine at which orders (periods a turn of the joint) its errors are expected;
/// see `lines_of`.
struct JointDrive {
  double gear_ratio = 0;    ///< turns of the gear's input in a turn of the joint; 0: unknown
  int encoder_periods = 0;  ///< signal periods of the encoder in a turn of the joint; 0: unknown

  /// Equal in both.
  bool operator==(const JointDrive&) const = default;
};

}  // namespace vernier
