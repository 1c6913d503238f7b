// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What an identification of the geometry estimated, as that of an error model without joint errors.

#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// The unknowns of an identified geometry, their covariance, and the residuals as noise of a visit.
/// @param identified        the arm as identified, in one set of frames
/// @param report            of its identification
/// @param position_sigma    of a visit, per component [m]
/// @param orientation_sigma of a visit, per component [rad]; 0 for positions alone
/// @throws std::invalid_argument where the report has no covariance, or is of another arm
VERNIER_API ErrorModelEstimate geometry_estimate(const ArmGeometry& identified, const IdentificationReport& report,
                                                 double position_sigma, double orientation_sigma);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/geometry_estimate.ipp"
#endif
