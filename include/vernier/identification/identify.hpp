// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Identification of an arm's geometry and frames by nonlinear least squares: in Ceres, which the component `ceres`
/// brings (vernier/ceres.hpp), or by the library's own solver.

#include <utility>
#include <vector>

#include "vernier/identification/detail/identification.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

namespace detail {

/// `GeometrySolver` by Ceres, which the component `ceres` defines.
struct CeresSolver {
  VERNIER_API SolverSummary operator()(CalibrationProblem& problem, int max_iterations) const;
};

/// An arm identified from sets of one place each, as the first sees it.
template <class Chain>
Identified<Chain> identified_from(const Framed<Chain>& arm, std::vector<MeasuredSet> sets,
                                  const IdentifyOptions& options, const SensorModel& sensors, GeometrySolver solver,
                                  bool own_tools = false) {
  const IdentifiedGeometry found =
      identify_geometry(ArmGeometry(arm), std::move(sets), options, sensors, solver, own_tools);
  return {found.report, {found.arm.framed(arm.model()), arm.model()}};
}

}  // namespace detail

/// Ceres as the solver of an identification.
inline constexpr detail::CeresSolver ceres_solver{};

/// Identifies the geometry of an arm and its base and tool frames from measurements (Levenberg-Marquardt).
///
/// Parameters that are linearly dependent on others in these measurements keep their values and are named; weakly
/// determined ones get a prior of physical size, so that they stay plausible; an underdetermined problem is reported as
/// such.
///
/// From distances to one fixed point the base frame has its origin at that point; its orientation, which distances do
/// not determine, is that of the start, and errors are those of distances.
/// @param nominal the arm as designed; its frames are known, or the start where they are to be identified
/// @param data    n >= 1 measurements from one place, e.g. a `Dataset` or `Distances`. Not kept.
/// @param options which parameters are estimated, with which priors
/// @param sensors accuracy of the measurements, and the loss; plain least squares by default
/// @param solver  `ceres_solver`, which needs the component, or `own_solver`, which needs Eigen alone
/// @return        model, status, rms before and after [m], rank, condition, covariance (empty where rank deficient)
/// @throws std::invalid_argument on no data, several sets or an unusable option, never for poor data
/// @complexity    O(n * free^2) per iteration; allocates
/// @cite          Hayati and Mirmirani 1985; Everett, Driels and Mooring 1987; Schroer 1997
template <NominalArm Arm>
Identified<ChainOf<Arm>> identify(const Arm& nominal, const Measurements<ChainOf<Arm>::dof>& data,
                                  const IdentifyOptions& options = {},
                                  const SensorModel& sensors = {.loss = Loss::squared},
                                  GeometrySolver solver = ceres_solver) {
  demand(data.sets().size() == 1, "identify: ", data.sets().size(),
         " sets of measurements; it takes one, `calibrate` takes several");
  return detail::identified_from(in_frames(nominal), {data.sets().front().with(sensors)}, options, sensors, solver);
}

}  // namespace vernier
