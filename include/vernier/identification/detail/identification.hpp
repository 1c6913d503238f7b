// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The steps of an identification, whatever the number of joints and the solver.

#include <vector>

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
/// @param sets      one a place: the links are shared, every place has a base of its own
/// @param own_tools whether every place has a tool of its own, too
/// @return          the arm as the first place sees it
VERNIER_API IdentifiedGeometry identify_geometry(const ArmGeometry& nominal, std::vector<MeasuredSet> sets,
                                                 const IdentifyOptions& options, const SensorModel& sensors,
                                                 GeometrySolver solver, bool own_tools = false);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/identification.ipp"
#endif
