// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Assessment of a calibration on held-out poses.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/calibration/calibration_report.hpp"
#include "vernier/calibration/pose_advice.hpp"
#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/data/same_pose.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

namespace detail {

/// Ranges of validity of a joint: no farther than its limits, unless it was measured there.
VERNIER_API std::vector<std::pair<double, double>> within_limits(const std::vector<JointRange>& ranges,
                                                                 const std::vector<std::pair<double, double>>& measured,
                                                                 double lower, double upper);

/// Transmission of a joint: sampled over its measured ranges, and its spectrum.
/// Whether an arm is known to be compliant to payload.
VERNIER_API bool payload_matters(const JointErrors& errors);
VERNIER_API void describe_transmission(const ErrorModelEstimate& estimate, int joint, JointReport& out);

/// A vector of one value a pose of all stations, one station after the other.
template <int N, class F>
VectorX over_stations(std::span<const Dataset<N>> stations, const F& values) {
  Index rows = 0;
  for (const auto& data : stations) rows += data.size();
  VectorX out(rows);
  Index at = 0;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    out.segment(at, stations[s].size()) = values(s, stations[s]);
    at += stations[s].size();
  }
  return out;
}

}  // namespace detail

/// Errors of held-out poses after every stage of a calibration, and what follows from them.
/// @param calibration from poses, one set a station
/// @param held_out    poses that it was not fitted to, as many sets in the same order
/// @param limits      of the controller's joints, for advice on poses
/// @param controller  how the chain's joints follow from those
/// @throws std::invalid_argument for another number of stations, no poses, or measurements that are no poses
template <class Chain>
CalibrationReport evaluate(const Calibration<Chain>& calibration, const Measurements<Chain::dof>& held_out,
                           const JointLimits<Chain::dof>& limits = {}, const ControllerMap& controller = {}) {
  constexpr int N = Chain::dof;
  const std::span<const Dataset<N>> test(held_out.poses());
  const FittedErrorModel<Chain>& errors = calibration.errors;
  const std::vector<ErrorModel<Chain>>& models = errors.models();
  const std::size_t stations = errors.stages.front().stage == Stage::frames ? errors.stages.front().models.size() : 0;
  demand(test.size() == stations && !test.empty(), "evaluate: ", test.size(), " sets of held-out poses for ", stations,
         " stations");
  demand(held_out.sets().size() == test.size(), "evaluate: ", held_out.sets().size() - test.size(), " of ",
         held_out.sets().size(), " sets of measurements are no data sets of poses; errors are those of poses");
  CalibrationReport out;
  out.identification = calibration.geometry;
  out.blocks = errors.blocks;
  out.train_poses = calibration.poses;
  out.others = calibration.others;
  out.oriented = calibration.oriented;
  for (const auto& data : test) out.oriented = out.oriented && data.has_orientations();
  out.converged = errors.converged;
  out.outliers = calibration.outliers;
  out.outliers_kept = calibration.outliers_kept;
  out.median_error = calibration.median_error;
  out.loss = calibration.sensors.loss;
  out.fit_seconds = calibration.fit_seconds;
  out.leave_one_out_seconds = errors.leave_one_out_seconds;

  const bool with_temperatures =
      std::all_of(test.begin(), test.end(), [](const auto& data) { return data.temperatures().size() > 0; });
  const char* last_title = "";  // of the last error model
  const auto assess = [&](const StagedModels<Chain>& staged) {
    const StageTraits& traits = traits_of(staged.stage);
    const auto poses = [&](std::size_t s, const Dataset<N>& data) {
      return detail::predicted_visits(staged.models[s], data, traits.thermal,
                                      traits.drift && s < errors.drift.size() ? errors.drift[s] : SessionDrift{});
    };
    const auto position = [&](std::size_t s, const Dataset<N>& data) {
      if (traits.visits) return detail::position_errors_of(poses(s, data), data.positions());
      if (detail::loaded_by(staged.models[s], data))
        return detail::position_errors_of(detail::predicted_under_payload(staged.models[s], data), data.positions());
      return position_errors(staged.models[s], data);
    };
    const auto rotation = [&](std::size_t s, const Dataset<N>& data) {
      if (traits.visits) return detail::rotation_errors_of(poses(s, data), data.orientations());
      if (detail::loaded_by(staged.models[s], data))
        return detail::rotation_errors_of(detail::predicted_under_payload(staged.models[s], data), data.orientations());
      return rotation_errors(staged.models[s], data);
    };
    out.stages.emplace_back(staged.stage, detail::over_stations<N>(test, position),
                            out.oriented ? detail::over_stations<N>(test, rotation) : VectorX());
    last_title = traits.title;
  };
  const auto assess_learned = [&](bool on_geometry, const std::vector<ErrorModel<Chain>>& below,
                                  std::span<const Dataset<N>> data) {
    const VectorX rotation = out.stages.back().rotation;
    for (const LearnedRemainder<N>& remainder : calibration.remainders) {
      if (remainder.on_geometry != on_geometry) continue;
      const CartesianCorrected hybrid(below.front(), remainder.predictor, remainder.coverage);
      out.stages.emplace_back(learned_stage(on_geometry, remainder.learner),
                              message(last_title, " + ", learner_title(remainder.learner)),
                              position_errors(hybrid, detail::in_first_frame<Chain>(below, data)), rotation);
    }
  };
  const auto assess_learned_on_models = [&] {
    assess_learned(false, models, detail::static_poses<Chain>(models, test, {}));
  };
  for (const StagedModels<Chain>& staged : errors.stages) {
    if (staged.stage == Stage::temperature && !with_temperatures) continue;
    if (staged.stage == Stage::session) assess_learned_on_models();
    assess(staged);
    if (staged.stage == Stage::geometry) assess_learned(true, staged.models, test);
  }
  if (errors.stages.back().stage != Stage::session) assess_learned_on_models();
  for (std::size_t s = 0; s < errors.drift.size(); ++s)
    if (detail::first_of_place(held_out.sets(), s) == s) out.drift.push_back(errors.drift[s]);
  out.prior = errors.prior;
  out.trials = calibration.trials;
  out.chosen = calibration.chosen();
  if (out.chosen == Stage::temperature && !with_temperatures)  // the stage before is what can be assessed
    for (const StagedModels<Chain>& staged : errors.stages)
      if (staged.stage < Stage::temperature) out.chosen = staged.stage;
  if (errors.model().thermal() != nullptr) out.mean_temperature = errors.mean_temperature;
  if (const auto& gravity = errors.arm.terms().gravity; gravity && errors.down_std > 0)
    out.down = EstimatedDown{gravity->down(), errors.down_std};
  if (const JointErrors& last = errors.model().identified().model().joint_errors(); last.terms().payload)
    out.payload = FittedPayload{last.terms().payload->reference().mass, detail::payload_matters(last)};

  const auto evaluation = [&](const auto& model) {
    const double began = detail::steady_seconds();
    double sum = 0;  // which nobody can optimise away
    Index count = 0;
    for (; count < 2000; ++count) {
      const Dataset<N>& data = test.front();
      sum += model.pose_and_jacobian(data.joints(count % data.size())).jacobian(0, 0);
    }
    const double seconds = detail::steady_seconds() - began;
    return std::isfinite(sum) ? seconds / static_cast<double>(count) : 0;
  };
  const LearnedRemainder<N>* deployed = calibration.deployed();
  const auto& chosen_model = deployed != nullptr ? calibration.model() : errors.models(out.chosen.stage).front();
  out.evaluation_seconds = deployed != nullptr
                               ? evaluation(CartesianCorrected(chosen_model, deployed->predictor, deployed->coverage))
                               : evaluation(chosen_model);

  Index rows = 0;
  for (const auto& data : test) rows += data.size();
  MatrixX joints(rows, N);
  rows = 0;
  for (const auto& data : test) {
    joints.middleRows(rows, data.size()) = data.joints();
    rows += data.size();
  }
  const auto types = errors.model().nominal().model().joint_types();
  out.held_out_poses = pose_numbers(joints, {.joint_types = types});
  out.block_error = errors.block_error;

  out.gates = detail::over_stations<N>(test, [&](std::size_t, const Dataset<N>& data) {
    VectorX gates(data.size());
    for (Index i = 0; i < data.size(); ++i) gates(i) = calibration.coverage(data.joints(i));
    return gates;
  });
  const LearnedRemainder<N>* learned = deployed != nullptr && !deployed->on_geometry ? deployed : nullptr;
  out.normalised_errors = detail::over_stations<N>(test, [&](std::size_t s, const Dataset<N>& data) {
    return detail::predicted_errors(errors, s, data, learned).normalised;
  });
  const auto within = std::count_if(out.normalised_errors.begin(), out.normalised_errors.end(),
                                    [](double error) { return error <= std::sqrt(chi_square_95); });
  out.ellipsoid_coverage = static_cast<double>(within) / static_cast<double>(out.normalised_errors.size());
  out.left_out_errors = errors.left_out_errors;
  out.left_out_rows = errors.left_out_rows;
  const VectorX &geometry = out.stage(Stage::geometry).position, &of_chosen = out.stage(out.chosen).position;
  for (Index i = 0; i < out.gates.size(); ++i)
    if (out.gates(i) >= 1) out.max_degradation = (std::max)(out.max_degradation, of_chosen(i) - geometry(i));
  const MatrixX chain_limits = controller.chain_limits(limits.lower, limits.upper);
  const std::vector<std::string> formulas =
      controller.same() ? std::vector<std::string>(N)
                        : controller.erring_joints(errors.model().nominal().model().joint_types());
  const MotorAngles& motors = calibration.coverage.motors;
  const MatrixX shown = motors.angles(joints);
  for (int j = 0; j < N; ++j) {
    JointReport joint;
    const int row = motors.row_of(j);
    const bool of_controller = !motors.none() && j < controller.joints();
    joint.revolute = errors.model().nominal().model().row(row).joint == JointType::revolute;
    joint.held_out.assign(shown.col(j).begin(), shown.col(j).end());
    const auto k = static_cast<std::size_t>(j);
    for (const auto& range : calibration.coverage.measured[k])
      joint.measured_ranges.emplace_back(range.lower, range.upper);
    joint.valid_ranges = detail::within_limits(calibration.coverage.ranges[k], joint.measured_ranges,
                                               of_controller ? limits.lower(j) : chain_limits(row, 0),
                                               of_controller ? limits.upper(j) : chain_limits(row, 1));
    if (formulas[k] != message('J', j + 1)) joint.formula = formulas[k];
    detail::describe_transmission(errors, j, joint);
    out.joints.push_back(std::move(joint));
  }
  out.advice = pose_advice(errors, out.identification, limits, calibration.sensors, out.oriented, 3, 3, controller);
  return out;
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/evaluate.ipp"
#endif
