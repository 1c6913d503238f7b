#pragma once

/// @file
/// Whether measurements fit an arm at all.

#include <string>

#include "vernier/calibration/calibration_failure.hpp"
#include "vernier/identification/detail/station.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier::detail {

/// Requires that registering base and tool leaves no error that a real arm cannot have: else the data are of another
/// arm, or in other units.
/// @param nominal    the arm without frames
/// @param frames_rms position error with registered frames [m]
/// @param arm,data   how the message names them
/// @throws CalibrationFailure with a guess at the cause
VERNIER_API void require_plausible(const ArmGeometry& nominal, const Station& poses, double frames_rms,
                                   const std::string& arm, const std::string& data);

/// The same for distances, given a registered arm.
VERNIER_API void require_plausible_distances(const ArmGeometry& registered, const Station& distances,
                                             const std::string& data);

/// The same for what its tool point touches.
VERNIER_API void require_plausible_contact(const ArmGeometry& registered, const Contact& contact);

/// Requires an identification that may be used.
/// @param step names it: "identifying the geometry"
/// @throws CalibrationFailure with advice
VERNIER_API void require_usable(const IdentificationReport& report, const std::string& step);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/plausibility.ipp"
#endif
