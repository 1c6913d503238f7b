// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a report shows over joint angles and over time.

#include <string>

#include "vernier/io/report_input.hpp"

namespace vernier::detail {

VERNIER_API std::string joints_section(const ReportInput& input);
VERNIER_API std::string drift_section(const ReportInput& input);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/report_functions.ipp"
#endif
