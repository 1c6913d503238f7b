#pragma once

/// @file
/// Identification with Ceres: `identify`, and `ceres_solver` for `calibrate`.

#include "vernier/ceres/identify.hpp"
