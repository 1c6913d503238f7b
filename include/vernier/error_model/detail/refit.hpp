// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fitted error model at other measurements of the same visits, without its decisions.

#include <vector>

#include "vernier/core/executor.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/measurements/measured_set.hpp"
#include "vernier/measurements/sensor_model.hpp"

namespace vernier::detail {

/// Whether `refit` can stand for a fit: nothing drifts, and no earlier calibration is the prior.
VERNIER_API bool can_refit(const ErrorModelEstimate& estimate);

/// The unknowns of an estimate fitted again, with their priors and from where they are. Left-out errors, covariance and
/// variances stay those of the fit.
/// @param sets of the same stations, in their order
VERNIER_API void refit(ErrorModelEstimate& estimate, std::vector<MeasuredSet> sets, const SensorModel& sensors,
                       ExecutorRef executor);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/refit.ipp"
#endif
