#pragma once

/// @file
/// Assessments of calibrations as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier {

/// Statistics of the errors of each stage, by its key: `mean_mm`, `rms_mm`, `max_mm`, `min_mm`, `p95_mm`, and
/// `mean_mrad` where orientations are used. Callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json stages_to_json(const std::vector<StageErrors>& stages);

/// An assessment of a calibration: stages, decisions on joint errors, parameters [mm, mrad], identifiability, verdict.
/// Callers include <nlohmann/json.hpp>.
/// @param report the assessment
/// @param robot  its name
VERNIER_API nlohmann::ordered_json to_json(const CalibrationReport& report, const std::string& robot);

/// A re-registration: `base_change_m_rad` and `tool_change_m_rad` (translation and rotation vector), `offsets_rad`, the
/// weights `position_sigma_mm` and `orientation_sigma_mrad`, `probe` (whether orientations are `turned`, `by_mrad`, and
/// `contradiction`, the statistic behind), `held` and `remarks` in words.
/// Callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json to_json(const ReregistrationReport& report);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/report_json.ipp"
#endif
