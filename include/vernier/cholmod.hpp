// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sparse solves by SuiteSparse's CHOLMOD, beside Eigen.

#include "vernier/cholmod/solver.hpp"
