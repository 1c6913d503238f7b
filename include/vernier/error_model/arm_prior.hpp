#pragma once

/// @file
/// An earlier calibration as the prior of a later one.

#include <array>
#include <string>
#include <vector>

#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// What an earlier calibration knows of an arm: the prior of a later one, of the same arm or of another of its type.
/// With mean m and covariance S of the earlier estimate and the expected sizes V0 of geometric and joint errors, the
/// prior is N(m, S + kappa^2 V0): kappa, one for the geometry and one for the joint errors, is how much of their sizes
/// has changed since, or differs between the arms, and follows from evidence. Deviations from the nominal chain are
/// what carries over; frames do not.
struct ArmPrior {
  std::string name;                               ///< for messages
  detail::ChainTable nominal;                     ///< the chain as designed
  ErrorModelEstimate estimate;                    ///< of one station
  std::vector<std::vector<JointRange>> ranges{};  ///< measured ranges of each joint [rad, m]; none: everywhere
  VectorX margins{};                              ///< of `JointCoverage`, one a joint
  std::array<double, 2> temperatures{};           ///< measured range [deg C], where the geometry changes with it
};

}  // namespace vernier
