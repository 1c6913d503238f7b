// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/compensation/concepts.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier {

VERNIER_IMPL void CorrectionOptions::validate(int dof) const {
  demand(moving_joints >= 0 && moving_joints <= dof, "CorrectionOptions: moving_joints is ", moving_joints,
         ", must lie in 0..", dof);
  demand(position_tolerance > 0 && rotation_tolerance > 0, "CorrectionOptions: tolerances ", position_tolerance,
         " m and ", rotation_tolerance, " rad must be positive");
  demand(max_iterations >= 1, "CorrectionOptions: max_iterations is ", max_iterations, ", must be at least 1");
}

namespace detail {

VERNIER_IMPL void require_same_frames(const char* caller, const PointRows& error) {
  double mean = 0;
  for (Index i = 0; i < error.rows(); ++i) mean += point(error, i).norm() / static_cast<double>(error.rows());
  demand(mean < 0.05, caller, ": model and data are ", brief(mean * 1e3),
         " mm apart on average; register the frames first (register_frames)");
}

}  // namespace detail
}  // namespace vernier
