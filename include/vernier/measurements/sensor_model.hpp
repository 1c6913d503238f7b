// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The accuracy of measurements, and how residuals are weighted.

#include "vernier/least_squares/loss.hpp"

namespace vernier {

/// Standard deviations of what is measured, and the loss. The ratios of the sigmas weight the sensors against each
/// other; reported uncertainties follow the residuals.
struct SensorModel {
  double position_sigma = 0.03e-3;    ///< of a measured position, per component [m]
  double orientation_sigma = 0.1e-3;  ///< of a measured orientation, per component [rad]
  double distance_sigma = 0.03e-3;    ///< of a measured distance [m]
  double contact_sigma = 0.03e-3;     ///< of a touch, per component, or across a face or a ball [m]
  double joint_sigma = 0;             ///< of the joint readings [rad, m]; above 0: errors in variables
  bool use_orientations = true;       ///< whether measured orientations are used
  Loss loss = Loss::huber;            ///< how residuals are weighted; huber tolerates outliers

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/sensor_model.ipp"
#endif
