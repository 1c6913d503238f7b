// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Whether measurements fit an arm at all.

#include <string>

#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/kinematics/arm_geometry.hpp"
#include "vernier/measurements/measured_set.hpp"

namespace vernier::detail {

/// Requires that registering base and tool leaves no error that a real arm cannot have: else the data are of another
/// arm, or in other units.
/// @param nominal    the arm without frames
/// @param frames_rms position error with registered frames [m]
/// @param arm        how the message names it
/// @throws CalibrationFailure with a guess at the cause
VERNIER_API void require_plausible(const ArmGeometry& nominal, const MeasuredSet& poses, double frames_rms,
                                   const std::string& arm);

/// Requires that measurements by any sensor fit an arm that poses have registered.
/// @throws CalibrationFailure with the sensor's complaint
VERNIER_API void require_plausible_set(const ArmGeometry& registered, MeasuredSet set);

/// Requires an identification that may be used.
/// @param step names it: "identifying the geometry"
/// @throws CalibrationFailure with advice
VERNIER_API void require_usable(const IdentificationReport& report, const std::string& step);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/plausibility.ipp"
#endif
