#pragma once

/// @file
/// Which joint errors an error model may have, and their expected sizes.

#include "vernier/core/types.hpp"

namespace vernier {

/// Options of `fit_error_model`. The defaults serve every robot; which blocks of joint errors the data support is
/// decided by leave-one-pose-out errors on those data.
struct ErrorModelOptions {
  bool compliance = true;              ///< elastic deflection of joints under gravity
  bool gear_ratio = true;              ///< joint errors proportional to the joint value; only beside joint-wise terms
  bool coupling = true;                ///< joint errors proportional to the value of the joint before; likewise
  int harmonics = 60;                  ///< of the Fourier terms of each joint; 0: none
  bool tool_per_station = false;       ///< every station has its own tool frame, not only its own base frame
  Vector3 down{0, 0, -1};              ///< direction of gravity in the arm's base frame
  double compliance_prior_std = 1e-3;  ///< expected product of compliance and weight [rad/m]
  double gear_ratio_prior_std = 1e-4;  ///< expected relative error of a gear ratio
  double coupling_prior_std = 1e-4;    ///< expected coupling
  double transmission_prior_std = 0.3e-3;  ///< expected amplitude of a first harmonic [rad]; of harmonic k, 1/k of it
  Index num_validation_poses = 200;        ///< approximate number of poses left out, one at a time, to validate a block

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/error_model_options.ipp"
#endif
