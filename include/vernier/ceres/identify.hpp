// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// `identify` with its solver, without the rest of the calibration pipeline.

#include "vernier/ceres/solver.hpp"
#include "vernier/identification/identify.hpp"
