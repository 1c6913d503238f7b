#pragma once

/// @file
/// Robots and calibrated models as JSON files: needs nlohmann-json beside Eigen.

#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"
