// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Populations on the threads of oneTBB: needs oneTBB beside Eigen.

#include "vernier/tbb/executor.hpp"
