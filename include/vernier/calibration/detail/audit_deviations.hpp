// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Faults beside the deviations that an arm may have from its design, for the audit of data: robust fits of the
/// geometry with priors decide between them.

#include <utility>

#include "vernier/calibration/detail/audit_hypotheses.hpp"

namespace vernier::detail {

/// A zero so small that other parameters of the chain hide it, or none: of the joint whose zero explains more than all
/// expected deviations of the geometry.
/// @param nominal       the arm as designed
/// @param frames        the nominal arm in frames that fit the rows
/// @param stds          of the parameters about their nominal values, see `audit_geometry_std`
/// @param smallest_zero that is named [rad]
/// @return the joint, from 0, and its zero [rad]; joint -1 for none
VERNIER_API std::pair<int, double> small_zero(const ArmGeometry& nominal, const AuditFit& frames, const AuditRows& rows,
                                              const VectorX& stds, double smallest_zero);

/// Whether a repair of rows that are plausible as they are explains them far better than deviations of the geometry do.
/// @param repair  a hypothesis with its fit
/// @param nominal the arm as designed
/// @param rows    as they are
/// @param stds    of the parameters about their nominal values
VERNIER_API bool repair_needed(const HypothesisFit& repair, const ArmGeometry& nominal, const AuditRows& rows,
                               const VectorX& stds);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/detail/audit_deviations.ipp"
#endif
