#pragma once

/// @file
/// The sections of a report; each is empty where the report has nothing of its kind.

#include <string>

#include "vernier/io/detail/pose_view.hpp"
#include "vernier/io/report_input.hpp"

namespace vernier::detail {

/// A section with its heading.
VERNIER_API std::string section(const std::string& id, const std::string& heading, const std::string& content);

/// Spearman's rank correlation of two series, and its two-sided p-value by the normal approximation.
/// @cite Spearman 1904
struct RankCorrelation {
  double rho = 0;
  double p_value = 1;
};
VERNIER_API RankCorrelation rank_correlation(const VectorX& a, const VectorX& b);

VERNIER_API std::string verdict_section(const ReportInput& input);
VERNIER_API std::string audit_section(const ReportInput& input);
VERNIER_API std::string errors_section(const ReportInput& input);
VERNIER_API std::string poses_section(const ReportInput& input, const PoseView& view);
VERNIER_API std::string coverage_section(const ReportInput& input);
VERNIER_API std::string parameters_section(const ReportInput& input);
VERNIER_API std::string joints_section(const ReportInput& input);
VERNIER_API std::string suspects_section(const ReportInput& input);
VERNIER_API std::string drift_section(const ReportInput& input);
VERNIER_API std::string advice_section(const ReportInput& input);
VERNIER_API std::string provenance_section(const ReportInput& input);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/report_sections.ipp"
#endif
