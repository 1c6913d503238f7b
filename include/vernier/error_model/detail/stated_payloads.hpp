// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What an arm carried while it was measured.

#include <optional>

#include "vernier/error_terms/payload_compliance.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"

namespace vernier::detail {

/// Payloads of a problem's measurements.
struct StatedPayloads {
  Payload mean;       ///< mass [kg], and centre in the frame of the flange [m] that gives the mean moment
  bool vary = false;  ///< whether any differs from it by more than a gram or a millimetre
};

/// The payloads that the measurements state; none where they state none.
/// @throws std::invalid_argument where a set of poses states none, and another does
VERNIER_API std::optional<StatedPayloads> stated_payloads(const CalibrationProblem& problem);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/stated_payloads.ipp"
#endif
