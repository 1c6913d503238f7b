// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Assessments of calibrations as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier {

/// Statistics of the errors of each stage, by its key: `mean_mm`, `rms_mm`, `max_mm`, `min_mm`, `p95_mm`, and
/// `mean_mrad` where orientations are used. Callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json stages_to_json(const std::vector<StageErrors>& stages);

/// An assessment of a calibration: stages, decisions on blocks, parameters [mm, mrad], identifiability, verdict. Under
/// `spectrum` each joint's amplitudes by order [urad], and its `lines` with margin and probable cause; under `drift`
/// the motion of each station's base at its knots. `mean_temperature_c` is null where temperature does not matter.
/// `held_out_mean_mm` is the mean error of all held-out poses by the deployed stage, with its 95 % interval; `upper` is
/// null for fewer than five poses. `verdict` has at most seven lines, `details` what stands behind them.
/// Callers include <nlohmann/json.hpp>.
/// @param report the assessment
/// @param robot  its name
VERNIER_API nlohmann::ordered_json to_json(const CalibrationReport& report, const std::string& robot);

/// A re-registration: `base_change_m_rad` and `tool_change_m_rad` (translation and rotation vector), `offsets_rad`, the
/// weights `position_sigma_mm` and `orientation_sigma_mrad`, `probe` (whether orientations are `turned`, `by_mrad`, and
/// `contradiction`, the statistic behind), `held` and `remarks` in words.
/// Callers include <nlohmann/json.hpp>.
VERNIER_API nlohmann::ordered_json to_json(const ReregistrationReport& report);

/// The outcome of a check: `valid`, `consistent`, `verdict`, the `stages` as_fitted and (where base or tool was)
/// registered, `chi_square`, `dof`, `p_value`, each of the `joints` [mrad, mm], the rows set `aside`, `registration` as
/// above or null, `advice`. Callers include <nlohmann/json.hpp>.
/// @param report the outcome
/// @param robot  name of the arm
VERNIER_API nlohmann::ordered_json to_json(const VerificationReport& report, const std::string& robot);

/// Position and orientation errors of a check: `as_fitted`, and `registered` where base or tool was.
VERNIER_API std::vector<StageErrors> stages_of(const VerificationReport& report);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/report_json.ipp"
#endif
