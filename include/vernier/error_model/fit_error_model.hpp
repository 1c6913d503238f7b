// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Fits geometry, frames and joint errors together, to measurements of any kinds from one place or several.

#include <algorithm>
#include <array>
#include <vector>

#include "vernier/error_model/arm_prior.hpp"
#include "vernier/error_model/detail/fit_input.hpp"
#include "vernier/error_model/error_model_options.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/error_model/prior_objective.hpp"
#include "vernier/identification/fitted_arm.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

namespace detail {

/// The arms of a stage without their type, one a station.
struct StagedArms {
  Stage stage;
  bool included;                ///< whether the data support the effect that the stage adds
  std::vector<FittedArm> arms;  ///< one a station
  bool last = false;            ///< whether these are the arms with everything
};

/// A fitted error model without its type.
struct ErrorModelOutput {
  ErrorModelEstimate estimate;
  std::vector<StagedArms> stages{};
  MatrixX joints{};                      ///< of all samples
  std::vector<VectorX> thermal_rates{};  ///< one a station; empty where the geometry does not change with temperature
  std::array<double, 2> temperatures{};  ///< lowest and highest [deg C]
};

/// `vernier::fit_error_model` for an arm whose number of joints is known at run time.
VERNIER_API ErrorModelOutput fit_error_model(ErrorModelInput input, const ErrorModelOptions& options,
                                             const SensorModel& sensors, PriorSearch search, ExecutorRef executor);

}  // namespace detail

/// Geometry, frames and joint errors of an arm in one regularised least-squares problem, solved on its normal
/// equations. Blocks of joint errors that leave-one-pose-out errors do not support are omitted.
/// @param start     an identified arm; its estimated parameters are estimated again, its weak ones keep their priors
/// @param measured  of any kinds, from any number of places: the chain is shared, every place has a frame of its own
/// @param options   which joint errors there may be, their expected sizes
/// @param sensors   accuracy of the measurements, and the loss
/// @param search    optimises the priors of the joint errors, e.g. a metaheuristic; by default their sizes follow from
///                  evidence
/// @param executor  computes normal equations; the fit does not depend on it
/// @throws std::invalid_argument on an unusable option, no measurements, or touches without poses
/// @complexity O(n u^2 / 6) an iteration for n poses and u unknowns, memory O(u^2)
template <int N, class Convention>
FittedErrorModel<DhChain<N, Convention>> fit_error_model(const Identified<DhChain<N, Convention>>& start,
                                                         const Measurements<DhChain<N, Convention>::dof>& measured,
                                                         const ErrorModelOptions& options = {},
                                                         const SensorModel& sensors = {}, PriorSearch search = {},
                                                         ExecutorRef executor = {}) {
  using Chain = DhChain<N, Convention>;
  const Chain& nominal = start.model.nominal().model();
  const detail::ErrorModelInput input{start, ArmGeometry(start.model.identified()), detail::ChainTable(nominal.view()),
                                      measured.sets(sensors)};
  detail::ErrorModelOutput found = detail::fit_error_model(input, options, sensors, search, executor);

  FittedErrorModel<Chain> out(std::move(found.estimate));
  const MotorAngles motors(options.controller);
  auto coverage = JointCoverage<N>::covering(found.joints, motors);
  for (int i = 0; i < N; ++i)
    coverage.periodic[static_cast<std::size_t>(i)] = nominal.row(motors.row_of(i)).joint == JointType::revolute;
  // what an earlier calibration measured is known, too
  const bool inherited = out.prior && out.prior->used;
  const JointCoverage<N> known = inherited ? coverage.joined(options.prior->ranges, options.prior->margins) : coverage;
  const auto elastic = std::find_if(found.stages.begin(), found.stages.end(),
                                    [](const detail::StagedArms& staged) { return staged.stage == Stage::elastic; });
  for (const detail::StagedArms& staged : found.stages) {
    const bool last = staged.last;
    StagedModels<Chain> models{staged.stage, staged.included, {}};
    for (std::size_t s = 0; s < staged.arms.size(); ++s) {
      const FittedArm& arm = staged.arms[s];
      const JointTerms& terms = arm.errors.terms();
      const bool gated = terms.size() > terms.num_dense_terms() || terms.tilt || terms.straightness;
      ErrorModel<Chain> model =
          gated ? ErrorModel<Chain>(nominal, arm.typed(nominal),
                                    elastic->arms[s].with_hysteresis_of(arm).typed(nominal), last ? known : coverage)
                : ErrorModel<Chain>(nominal, arm.typed(nominal));
      if (last && !found.thermal_rates.empty())
        model = model.with_thermal(
            {out.mean_temperature, found.temperatures[0], found.temperatures[1], found.thermal_rates[s]});
      models.models.push_back(std::move(model));
    }
    out.stages.push_back(std::move(models));
  }
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/fit_error_model.ipp"
#endif
