// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The solver of `identify`, by Ceres.

#include "vernier/identification/identify.hpp"

#if VERNIER_HEADER_ONLY
#include "vernier/ceres/solver.ipp"
#endif
