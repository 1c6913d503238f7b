// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What the HTML page of `calibrate --report` shows of a calibration.

#include "calibration_data.hpp"
#include "calibration_options.hpp"
#include "vernier/calibration/calibration_report.hpp"
#include "vernier/io/html_report.hpp"
#include "vernier/io/robot_file.hpp"

namespace support {

/// A page with the held-out poses, the rows of all poses in their files, and the files that were read. Compiled in
/// calibration_page.cpp, for all numbers of joints.
template <int N>
vernier::ReportInput calibration_page(const vernier::CalibrationReport& report, const CalibrationOptions& options,
                                      const vernier::DescribedRobot<N>& robot, const MeasuredFiles<N>& measured);

}  // namespace support
