// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An earlier calibration as the prior of a later one.

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "vernier/error_model/error_model.hpp"
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

/// A fitted arm as the prior of another fit.
/// @param name     for messages
/// @param model    of its first station
/// @param estimate of that station, see `ErrorModelEstimate::first_station`
template <class Chain>
ArmPrior arm_prior(std::string name, const ErrorModel<Chain>& model, ErrorModelEstimate estimate) {
  ArmPrior out{std::move(name), detail::ChainTable(model.nominal().model().view()), std::move(estimate)};
  if (const auto* coverage = model.coverage()) {
    out.ranges.assign(coverage->ranges.begin(), coverage->ranges.end());
    out.margins = coverage->margin;
  }
  if (const ThermalRates* thermal = model.thermal()) out.temperatures = {thermal->lower, thermal->upper};
  return out;
}

}  // namespace vernier
