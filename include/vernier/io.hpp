#pragma once

/// @file
/// Robots, calibrated models and searches under way as JSON files: needs nlohmann-json beside Eigen.

#include "vernier/io/model_file.hpp"
#include "vernier/io/robot_file.hpp"
#include "vernier/io/search_state.hpp"
