// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The verdict of a report, and the rows that are suspect.

#include <string>

#include "vernier/io/report_input.hpp"

namespace vernier::detail {

VERNIER_API std::string verdict_section(const ReportInput& input);
VERNIER_API std::string suspects_section(const ReportInput& input);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/report_verdict.ipp"
#endif
