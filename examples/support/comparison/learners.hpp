// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Learners by name, compiled once for each number of joints that comparisons serve.

#include <functional>

#include "comparison.hpp"
#include "vernier/core/types.hpp"

namespace support {

/// Position errors [m] at rows of joints.
template <int N>
using LearnedErrors = std::function<vernier::PointRows(const vernier::JointRows<N>&)>;

/// What a learner makes of samples, perhaps by a search.
/// @param joints  n x N [rad, m]
/// @param errors  n x 3 [m]
/// @param record  of the search, if there is one
template <int N>
LearnedErrors<N> learn(const Method& method, const Plan& plan, const vernier::JointRows<N>& joints,
                       const vernier::PointRows& errors, const vernier::FitOptions& options, Convergence& record);

}  // namespace support
