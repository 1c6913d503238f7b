// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Identification with Ceres: `identify`, and `ceres_solver` for `calibrate`.

#include "vernier/ceres/identify.hpp"
