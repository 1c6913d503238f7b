// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The sections of a report; each is empty where the report has nothing of its kind.

#include <string>
#include <vector>

#include "vernier/io/detail/pose_view.hpp"
#include "vernier/io/report_input.hpp"

namespace vernier::detail {

/// A paragraph of text, escaped.
VERNIER_API std::string paragraph(const std::string& text, const char* kind = "");
/// Texts as a list, escaped; empty without any.
VERNIER_API std::string bullets(const std::vector<std::string>& texts);
/// A section with its heading.
VERNIER_API std::string section(const std::string& id, const std::string& heading, const std::string& content);

VERNIER_API std::string audit_section(const ReportInput& input);
VERNIER_API std::string errors_section(const ReportInput& input);
VERNIER_API std::string poses_section(const ReportInput& input, const PoseView& view);
VERNIER_API std::string coverage_section(const ReportInput& input);
VERNIER_API std::string parameters_section(const ReportInput& input);
VERNIER_API std::string advice_section(const ReportInput& input);
VERNIER_API std::string provenance_section(const ReportInput& input);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/report_sections.ipp"
#endif
