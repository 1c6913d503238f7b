// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Robots, calibrated models, reports and searches under way as JSON: needs nlohmann-json beside Eigen.

#include "vernier/io/audit_json.hpp"
#include "vernier/io/export_c.hpp"
#include "vernier/io/identified_robot.hpp"
#include "vernier/io/iso9283_json.hpp"
#include "vernier/io/model_file.hpp"
#include "vernier/io/model_text.hpp"
#include "vernier/io/report_json.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/io/search_state.hpp"
#include "vernier/io/ur_calibration.hpp"
