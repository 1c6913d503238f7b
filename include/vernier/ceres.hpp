#pragma once

/// @file
/// The solver side of Vernier: needs Ceres beside Eigen.

#include "vernier/ceres/calibrate.hpp"
