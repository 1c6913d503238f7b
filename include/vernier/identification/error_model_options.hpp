#pragma once

/// @file
/// Which joint errors an error model may have, and what its sensors are good for.

#include <cmath>
#include <utility>

#include "vernier/identification/options.hpp"

namespace vernier {

/// Options of `fit_error_model`: which joint errors there may be, how large they are expected, how good the sensor is.
/// The defaults serve every robot; how far the data support a block is decided by leave-one-pose-out on those data.
struct ErrorModelOptions {
  bool compliance = true;             ///< joints give way under gravity
  bool gear_ratio = true;             ///< joint errors proportional to the joint; where joint-wise terms are in
  bool coupling = true;               ///< joint errors proportional to the joint before; likewise
  int harmonics = 60;                 ///< of the Fourier terms of each joint; 0: none
  int joint_nodes = 0;                ///< above 0: so many hidden nodes that read one joint, in place of Fourier terms
  bool own_tools = false;             ///< every station has a tool of its own, not just a base
  bool use_orientations = true;       ///< measured orientations count too, where there are any
  Vector3 down{0, 0, -1};             ///< direction of gravity in the arm's base frame
  double position_sigma = 0.03e-3;    ///< of the sensor, per component [m]
  double orientation_sigma = 0.1e-3;  ///< of the sensor, per component [rad]
  double distance_sigma = 0.03e-3;    ///< of a measured distance [m]
  double joint_sigma = 0;             ///< of the joint readings [rad, m]; above 0: errors in variables
  double compliance_size = 1e-3;      ///< expected product of compliance and weight [rad/m]
  double gear_ratio_size = 1e-4;      ///< expected relative error of a gear ratio
  double coupling_size = 1e-4;        ///< expected coupling
  double transmission_size = 0.3e-3;  ///< expected amplitude of a first harmonic [rad]; harmonic k: a k-th of it
  Loss loss = Loss::huber;            ///< how residuals are weighed; huber survives a few wrong poses
  Index left_out = 200;               ///< about so many poses are left out, one at a time, to judge a block

  /// @throws std::invalid_argument naming the value
  void validate() const {
    for (const auto& [name, value] : {std::pair{"position_sigma", position_sigma},
                                      {"orientation_sigma", orientation_sigma},
                                      {"distance_sigma", distance_sigma},
                                      {"compliance_size", compliance_size},
                                      {"gear_ratio_size", gear_ratio_size},
                                      {"coupling_size", coupling_size},
                                      {"transmission_size", transmission_size}})
      require(value > 0 && std::isfinite(value), "ErrorModelOptions: ", name, " is ", value, ", must be positive");
    require(joint_sigma >= 0 && std::isfinite(joint_sigma), "ErrorModelOptions: joint_sigma is ", joint_sigma,
            ", must not be negative");
    require(harmonics >= 0 && harmonics <= 500, "ErrorModelOptions: harmonics is ", harmonics, ", must lie in 0..500");
    require(joint_nodes >= 0 && joint_nodes <= 1000, "ErrorModelOptions: joint_nodes is ", joint_nodes,
            ", must lie in 0..1000");
    require(left_out >= 1, "ErrorModelOptions: left_out is ", left_out, ", must be at least 1");
    require(std::abs(down.norm() - 1) < 1e-6, "ErrorModelOptions: down has length ", down.norm(), ", must be 1");
  }
};

}  // namespace vernier
