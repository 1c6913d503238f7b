#pragma once

/// @file
/// Sparse solves by SuiteSparse's CHOLMOD, beside Eigen.

#include "vernier/cholmod/solver.hpp"
