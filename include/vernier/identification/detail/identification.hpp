#pragma once

/// @file
/// The steps of an identification, whatever the number of joints and the solver.

#include <string>

#include "vernier/core/function_ref.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/identification/options.hpp"

namespace vernier::detail {

/// Outcome of a nonlinear solve.
struct SolverSummary {
  bool converged = true;
  int iterations = 0;
  std::string message;
};

/// Minimises a problem from its present values; a robust loss settles its scale.
using GeometrySolver = FunctionRef<SolverSummary(CalibrationProblem& problem, int max_iterations)>;

/// An identified geometry and its report.
struct IdentifiedGeometry {
  ArmGeometry arm;
  IdentificationReport report;
};

/// See `vernier::identify`.
VERNIER_API IdentifiedGeometry identify_geometry(const ArmGeometry& nominal, const MeasuredSet& data,
                                                 const IdentifyOptions& options, const SensorModel& sensors,
                                                 GeometrySolver solver);

/// `GeometrySolver` by Ceres, which the component `ceres` defines (vernier/ceres.hpp).
struct CeresSolver {
  VERNIER_API SolverSummary operator()(CalibrationProblem& problem, int max_iterations) const;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/identification.ipp"
#endif
