// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Identification without Ceres, for problems that are near their solution.

#include "set_of.hpp"
#include "vernier/identification/detail/identification.hpp"
#include "vernier/identification/identified.hpp"

namespace vernier_test {

/// A geometry solver: undamped Gauss-Newton steps.
inline vernier::SolverSummary gauss_newton(vernier::detail::CalibrationProblem& problem, int max_iterations) {
  const bool converged = problem.solve(max_iterations);
  problem.reset_weights();
  return {converged, max_iterations, "Gauss-Newton"};
}

/// `identify` by it.
template <class Chain, class Data>
vernier::Identified<Chain> identify_by_gauss_newton(const vernier::Framed<Chain>& arm, const Data& data,
                                                    const vernier::IdentifyOptions& options,
                                                    const vernier::SensorModel& sensors) {
  const auto found = vernier::detail::identify_geometry(
      vernier::ArmGeometry(arm), {vernier_test::set_of(data, sensors)}, options, sensors, gauss_newton);
  return {found.report, {found.arm.framed(arm.model()), arm.model()}};
}

}  // namespace vernier_test
