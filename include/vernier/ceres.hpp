#pragma once

/// @file
/// Identification with Ceres, and the calibration pipeline, which starts with it.

#include "vernier/calibration/calibrate.hpp"
#include "vernier/calibration/evaluate.hpp"
#include "vernier/ceres/identify.hpp"
