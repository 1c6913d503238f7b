// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The report of a calibration, or of its yearly check, as one HTML page that needs nothing else.

#include <string>
#include <vector>

#include "vernier/calibration/calibration_report.hpp"
#include "vernier/calibration/verify_calibration.hpp"
#include "vernier/io/report_input.hpp"

namespace vernier {

/// The report of an assessment: stages, joints, parameters, drift, advice and all results as JSON, but the poses and
/// where it comes from.
/// @param report     the assessment
/// @param robot      its name
/// @param train_rows names of the training poses, one station after the other; by default their numbers
VERNIER_API ReportInput report_input(const CalibrationReport& report, const std::string& robot,
                                     const std::vector<std::string>& train_rows = {});

/// The report of a yearly check, likewise: verdict, errors, joint by joint, registration, advice.
VERNIER_API ReportInput report_input(const VerificationReport& report, const std::string& robot);

/// The page. It asks for nothing from elsewhere, which its content security policy states, and can be read without its
/// script, in print and in the dark. The same values make the same bits. Every text in it is escaped. Of more than
/// 5,000 poses the view shows 5,000.
///
/// With its script the view of poses follows the fragment of its address: `#rotate=90&tilt=20&show=before` (degrees;
/// `before` or `after`), and the root element has `data-state="ready"` and `data-points`, their number.
/// @throws std::invalid_argument for stages without the ones before and after, or of another number than the poses
VERNIER_API std::string report_html(const ReportInput& input);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/io/html_report.ipp"
#endif
