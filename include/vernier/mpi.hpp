// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Populations shared out over MPI ranks: needs an MPI library beside Eigen.

#include "vernier/mpi/executor.hpp"
