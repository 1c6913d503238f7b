// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An earlier calibration in the unknowns of a new problem, and how much of it holds.

#include "vernier/error_model/arm_prior.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/least_squares/evidence.hpp"

namespace vernier::detail {

/// Unknowns of a problem that an earlier calibration knows, geometric ones first, in steps of their scales; variances
/// relative to that of whitened noise.
struct TransferredUnknowns {
  UnknownGroup unknowns;
  Index geometric = 0;  ///< number of geometric ones
  VectorX mean;
  MatrixX covariance;
  VectorX expected;  ///< variances of the expected sizes

  /// The covariance as it is after some change of geometry and joint errors.
  VERNIER_API MatrixX widened(double geometry, double joints) const;
  /// The prior of a problem with some number of unknowns.
  VERNIER_API JointPrior prior(Index size, double geometry, double joints) const;
};

/// The unknowns of a problem with those that only the earlier calibration knows; without priors where it knows them.
VERNIER_API std::vector<GeometricUnknown> with_unknowns_of(const ArmPrior& prior,
                                                           std::vector<GeometricUnknown> unknowns);

/// @param arm     with the unknowns of `with_unknowns_of` and all joint errors of the earlier estimate
/// @param nominal the chain as designed
VERNIER_API TransferredUnknowns transferred_unknowns(const ArmPrior& prior, const ArmParameterisation& arm,
                                                     const ChainTable& nominal);

/// The changes of geometry and joint errors, on a grid, that have most evidence; of a problem near its solution.
VERNIER_API PriorTransfer likely_transfer(const CalibrationProblem& problem, const TransferredUnknowns& known);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/prior_transfer.ipp"
#endif
