#pragma once

/// @file
/// What drives the joints of an arm, as far as it is known.

namespace vernier {

/// Gear and encoder of a joint. Their periods are the orders at which a joint errs.
struct JointDrive {
  double gear_ratio = 0;    ///< turns of the motor in a turn of the joint; 0: unknown
  int encoder_periods = 0;  ///< periods of the encoder in a turn of the joint; 0: unknown

  /// Equal in both.
  bool operator==(const JointDrive&) const = default;
};

}  // namespace vernier
