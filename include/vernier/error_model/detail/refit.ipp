// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/error_model/detail/refit.hpp"
#include "vernier/identification/detail/calibration_problem.hpp"

namespace vernier::detail {

VERNIER_IMPL bool can_refit(const ErrorModelEstimate& estimate) {
  return estimate.drift.empty() && !(estimate.prior && estimate.prior->used) && !(estimate.temperature_std > 0);
}

VERNIER_IMPL void refit(ErrorModelEstimate& estimate, std::vector<MeasuredSet> sets, const SensorModel& sensors,
                        ExecutorRef executor) {
  CalibrationProblem problem(estimate.arm, std::move(sets), sensors.loss, sensors.joint_sigma);
  problem.executor = executor;
  constexpr double least_gain = 1e-10;  // the arm follows changes that hardly lower the sum of squares
  estimate.converged = problem.solve(30, least_gain).converged;
  estimate.arm = problem.arm;
}

}  // namespace vernier::detail
