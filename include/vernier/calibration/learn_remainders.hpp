// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Learns what the models of a calibration leave, and decides by cross-validation what of it is deployed.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/data/same_pose.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/evaluation/sign_flip_test.hpp"
#include "vernier/least_squares/leave_one_out.hpp"
#include "vernier/least_squares/prior_choice.hpp"
#include "vernier/regression/kernel_elm.hpp"
#include "vernier/regression/ridge_elm.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier::detail {

/// Errors of the models of all stations at poses as they were visited, of one station.
template <class Chain>
VectorX visited_errors(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data) {
  return position_errors_of(predicted_visits(model, data, true, {}), data.positions());
}

/// The pose of each row.
template <class Chain>
std::vector<Index> poses_of(const ErrorModel<Chain>& model, const JointRows<Chain::dof>& joints) {
  const auto types = model.nominal().model().joint_types();
  return pose_numbers(joints, {.joint_types = types});
}

/// Learns what a model leaves at some poses in its frame. Each pose counts once, with the mean of its rows: learners
/// choose among themselves by left-out rows, which must not be of a pose that they have seen.
template <class Chain>
LearnedRemainder<Chain::dof> learn_remainder(bool on_geometry, Learner learner, const ErrorModel<Chain>& model,
                                             const Dataset<Chain::dof>& data, const RemainderOptions& options,
                                             const FitOptions& fit) {
  const RidgeElm elm{.hidden_nodes = options.hidden_nodes};
  const std::vector<Index> poses = poses_of(model, data.joints());
  const std::vector<Index> first = first_rows(poses);
  const JointRows<Chain::dof> joints = data.rows(first).joints();
  const PointRows error = means_of_rows(positions(model, data.joints()) - data.positions(), poses);
  const auto learned = [&](const auto& recipe) -> LearnedError<Chain::dof> { return recipe.fit(joints, error, fit); };
  return {on_geometry, learner,
          learner == Learner::pso_elm     ? learned(Tuned<RidgeElm, Pso>{elm, Pso{.particles = options.particles,
                                                                                  .iterations = options.iterations,
                                                                                  .positions = PositionRule::clamped}})
          : learner == Learner::ridge_elm ? learned(elm)
                                          : learned(KernelElm{.input_map = InputMap::sines_and_cosines}),
          JointCoverage<Chain::dof>::covering(data.joints())};
}

/// Errors of poses left out, with all their rows, in folds of consecutive ones, of which what is learned on the others
/// is taken off.
template <class Chain>
VectorX fold_errors(Learner learner, const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data,
                    const RemainderOptions& options, const FitOptions& fit) {
  constexpr Index folds = 5;
  const std::vector<Index> poses = poses_of(model, data.joints());
  const Index different = *std::max_element(poses.begin(), poses.end()) + 1;
  VectorX out(data.size());
  for (Index fold = 0; fold < folds; ++fold) {
    const Index begin = fold * different / folds, end = (fold + 1) * different / folds;
    std::vector<Index> inside, left_out;
    for (Index i = 0; i < data.size(); ++i) {
      const Index pose = poses[static_cast<std::size_t>(i)];
      (pose >= begin && pose < end ? left_out : inside).push_back(i);
    }
    const auto learned = learn_remainder(false, learner, model, data.rows(inside), options,
                                         {.seed = fit.seed, .executor = fit.executor});
    const VectorX errors =
        position_errors(CartesianCorrected(model, learned.predictor, learned.coverage), data.rows(left_out));
    for (std::size_t k = 0; k < left_out.size(); ++k) out(left_out[k]) = errors(static_cast<Index>(k));
  }
  return out;
}

/// Whether errors are smaller, by more than a standard error and more than chance makes them in one of twenty
/// calibrations.
/// @param errors,others of the same poses
/// @param looks         how often a calibration asks this
/// @cite Fisher 1935
VERNIER_API inline bool clearly_better(const VectorX& errors, const VectorX& others, std::size_t looks) {
  const VectorX saved = others.cwiseAbs2() - errors.cwiseAbs2();
  if (!saved.allFinite()) return errors.allFinite();  // the others do not predict each pose
  return errors.mean() < others.mean() && one_standard_error_rule({{0, errors}, {1, others}}) == 0 &&
         sign_flip_test(saved) < 0.05 / static_cast<double>(looks);
}

/// The best learner on one model.
struct BestLearner {
  std::size_t trial = 0;
  bool helps = false;  ///< by more than a standard error
  VectorX left_out;    ///< leave-one-pose-out errors of the model, changed as learning changes those of left-out folds
};

/// Tries learners on the models of one stage, and learns the first of them from all poses. Folds tell how learning
/// changes the errors of models that were fitted to all poses. How these predict a pose that they have not seen is
/// known from its leave-one-pose-out error.
/// @param stations poses, one set a station
/// @param left_out leave-one-pose-out errors of the model [m]
/// @param rows     of which poses, counted over the stations
template <class Chain>
std::optional<BestLearner> try_learners(Calibration<Chain>& out, bool on_geometry,
                                        const std::vector<ErrorModel<Chain>>& models,
                                        std::span<const Dataset<Chain::dof>> stations, const VectorX& left_out,
                                        const std::vector<Index>& rows, const RemainderOptions& options,
                                        const FitOptions& fit) {
  constexpr Index enough = 10;
  const Dataset<Chain::dof> data = in_first_frame<Chain>(models, stations);
  const ErrorModel<Chain>& model = models.front();
  out.remainders.push_back(learn_remainder(on_geometry, options.learners.front(), model, data, options, fit));
  const std::vector<Index> poses = poses_of(model, data.joints());
  if (*std::max_element(poses.begin(), poses.end()) + 1 < enough) return {};
  const VectorX without = position_errors(model, data);
  const auto changed = [&](const VectorX& with) {
    VectorX errors = left_out;
    for (Index k = 0; k < errors.size(); ++k) {
      const Index row = rows[static_cast<std::size_t>(k)];
      errors(k) += with(row) - without(row);
    }
    return errors;
  };
  std::vector<PriorTrial> errors;  // the preferred one last
  for (const Learner learner : options.learners) {
    if (learner == Learner::kernel_elm && data.size() > options.max_kernel_poses) continue;
    errors.insert(errors.begin(), {0, fold_errors(learner, model, data, options, fit)});
    out.trials.push_back({on_geometry, learner, left_out.mean(), changed(errors.front().errors).mean()});
  }
  if (errors.empty()) return {};
  const std::size_t best = one_standard_error_rule(errors);
  const VectorX& with = errors[best].errors;
  const std::size_t looks = 2 * options.learners.size();
  return BestLearner{out.trials.size() - 1 - best,
                     clearly_better(means_of_poses(with, poses), means_of_poses(without, poses), looks), changed(with)};
}

/// Learns what the stages leave, as `RemainderOptions` says. What is learned on geometry is deployed where it predicts
/// left-out poses better than the error model does, by more than a standard error.
template <class Chain>
void learn_remainders(Calibration<Chain>& out, std::span<const Dataset<Chain::dof>> stations,
                      const RemainderOptions& options, const FitOptions& fit) {
  const FittedErrorModel<Chain>& errors = out.errors;
  if (options.learners.empty()) return;
  std::optional<BestLearner> on_geometry, on_model;
  if (options.on_geometry)
    on_geometry = try_learners<Chain>(out, true, errors.models(Stage::geometry), stations,
                                      errors.geometry_left_out_errors, errors.left_out_rows, options, fit);
  if (options.on_error_model)
    on_model =
        try_learners<Chain>(out, false, errors.models(), static_poses<Chain>(errors.models(), stations, errors.drift),
                            errors.left_out_errors, errors.left_out_rows, options, fit);
  std::optional<std::size_t> chosen;
  if (on_model && on_model->helps) chosen = on_model->trial;
  if (on_geometry) {
    const std::vector<Index> all = poses_of(errors.model(), in_first_frame<Chain>(errors.models(), stations).joints());
    std::vector<Index> poses;
    for (const Index row : errors.left_out_rows) poses.push_back(all[static_cast<std::size_t>(row)]);
    const VectorX& others = chosen ? on_model->left_out : errors.left_out_errors;
    if (clearly_better(means_of_poses(on_geometry->left_out, poses), means_of_poses(others, poses),
                       2 * options.learners.size()))
      chosen = on_geometry->trial;
  }
  if (!chosen) return;
  RemainderTrial& trial = out.trials[*chosen];
  trial.supported = true;
  for (std::size_t k = 0; k < out.remainders.size(); ++k)
    if (out.remainders[k].on_geometry == trial.on_geometry && out.remainders[k].learner == trial.learner)
      out.deployed_remainder = k;
  if (!out.deployed_remainder) {
    const auto& models = trial.on_geometry ? errors.models(Stage::geometry) : errors.models();
    const std::vector<Dataset<Chain::dof>> still = static_poses<Chain>(errors.models(), stations, errors.drift);
    out.deployed_remainder = out.remainders.size();
    out.remainders.push_back(learn_remainder(
        trial.on_geometry, trial.learner, models.front(),
        in_first_frame<Chain>(models, trial.on_geometry ? stations : std::span<const Dataset<Chain::dof>>(still)),
        options, fit));
  }
  if (out.remainders[*out.deployed_remainder].empty()) {  // nothing but a mean
    out.deployed_remainder.reset();
    trial.supported = false;
  }
}

}  // namespace vernier::detail
