// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What an identification from contacts found: parameters with standard deviations, objects, what touches do not
/// determine.

#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/detail/contact_problem.hpp"

namespace vernier::detail {

/// @param solved     at its solution
/// @param identified the arm
/// @param selection  what was estimated, and what was not identifiable
/// @param converged  whether the iteration did
VERNIER_API ContactReport contact_report(const ContactProblem& solved, const ArmGeometry& identified,
                                         const ContactSelection& selection, bool converged);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/identification/detail/contact_assessment.ipp"
#endif
