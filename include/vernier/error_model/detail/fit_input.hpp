// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Where the fit of an error model starts: arms, unknowns and measurements of all stations.

#include <vector>

#include "vernier/error_model/error_model_options.hpp"
#include "vernier/identification/arm_parameterisation.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// Where a fit starts, and what it is fitted to.
struct ErrorModelInput {
  const IdentificationReport& identification;
  ArmGeometry identified;  ///< seen from the first station
  ChainTable nominal;      ///< for the torques of gravity
  /// Those that locate the base first. Registered with the identified arm, which may turn a set's frame.
  std::vector<MeasuredSet> sets;
  std::vector<ArmGeometry> arms{};  ///< the identified arm in the frame of each set

  /// Registers all sets.
  /// @throws std::invalid_argument for a set without measurements, or touches of a plane along a line
  VERNIER_API void place();
};

/// What is estimated: what the identification estimated, frames per set as far as it determines them.
VERNIER_API std::vector<GeometricUnknown> geometric_unknowns(const ErrorModelInput& input,
                                                             const ErrorModelOptions& options);

/// Numbers of the unknowns of an arm's links, without their changes with temperature.
VERNIER_API std::vector<Index> link_unknowns(const ArmParameterisation& arm);

/// Joint errors that an arm with nominal links does not show apart from its frames, for example what gravity does to an
/// axis that is always vertical. Found tilts would show them by milliradians, and the frames would run away along them.
/// @param problem with the joint errors in question
/// @param nominal the chain as designed
/// @return        coefficients before the transmission's
VERNIER_API std::vector<Index> hidden_terms(const CalibrationProblem& problem, const ChainTable& nominal);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/fit_input.ipp"
#endif
