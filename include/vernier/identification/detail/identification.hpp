#pragma once

/// @file
/// The steps of an identification, whatever the number of joints and the solver.

#include "vernier/identification/detail/calibration_problem.hpp"
#include "vernier/identification/geometry_solver.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/identification/options.hpp"

namespace vernier::detail {

/// An identified geometry and its report.
struct IdentifiedGeometry {
  ArmGeometry arm;
  IdentificationReport report;
};

/// `vernier::identify` for an arm whose number of joints is known at run time.
VERNIER_API IdentifiedGeometry identify_geometry(const ArmGeometry& nominal, const MeasuredSet& data,
                                                 const IdentifyOptions& options, const SensorModel& sensors,
                                                 GeometrySolver solver);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/identification.ipp"
#endif
