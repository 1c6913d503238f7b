// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The calibration pipeline: from measurements to everything known of a real arm.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/calibration/detail/outlier_screening.hpp"
#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/calibration/learn_remainders.hpp"
#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/measurements/measurements.hpp"

namespace vernier {

/// Options of `calibrate`.
struct CalibrateOptions {
  IdentifyOptions geometry{.frames = Frames::base_and_tool};  ///< of the geometric identification
  ErrorModelOptions errors{};                                 ///< of the joint errors
  SensorModel sensors{};                                      ///< of all measurements, for every step
  RemainderOptions remainder{};                               ///< of what is learned on top
  FitOptions fit{};                  ///< seed and observer of what is learned, executor of that and of the error model
  PriorSearch search{};              ///< of priors, see `fit_error_model`
  GeometrySolver solver{};           ///< of the geometric identification; by default `own_solver`, or `ceres_solver`
  bool keep_outliers = false;        ///< learn from training rows that are outliers, too
  bool refuse_implausible = true;    ///< throw for data that do not fit the arm, or do not support a calibration
  std::string arm_name = "the arm";  ///< how messages name the arm
};

namespace detail {

/// Measurements without some rows of their poses.
template <int N>
Measurements<N> without_rows(const Measurements<N>& measured, const std::vector<OutlyingRow>& outliers) {
  std::vector<Dataset<N>> poses;
  for (std::size_t s = 0; s < measured.poses().size(); ++s)
    poses.push_back(measured.poses()[s].rows(other_rows(outliers, s, measured.poses()[s].size())));
  return measured.with_poses(std::move(poses));
}

/// Frames, geometry and error model of an arm, from rows that are no outliers.
template <class Chain>
Calibration<Chain> fitted(const Framed<Chain>& nominal, const Measurements<Chain::dof>& measured,
                          const CalibrateOptions& options) {
  const std::size_t stations = measured.poses().size();
  const std::vector<MeasuredSet> sets = measured.sets(options.sensors);
  const GeometrySolver solver = options.solver ? options.solver : GeometrySolver(own_solver);

  IdentifyOptions frames_alone = options.geometry;
  frames_alone.geometry = false;
  StagedModels<Chain> frames{Stage::frames, true, {}};
  for (std::size_t s = 0; s < stations; ++s) {
    std::vector<MeasuredSet> there_measured{sets[s]};
    for (std::size_t other = 0; other < stations; ++other)
      if (other != s && first_of_place(sets, other) == first_of_place(sets, s)) there_measured.push_back(sets[other]);
    const auto registered = identified_from(nominal, std::move(there_measured), frames_alone, options.sensors, solver,
                                            options.errors.tool_per_station);
    if (options.refuse_implausible) {
      if (!options.keep_outliers)
        require_plausible(ArmGeometry(nominal), sets[s], registered.rms_after, options.arm_name);
      require_usable(registered, "registering the frames");
    }
    const Framed<Chain>& there = registered.model.identified();
    frames.models.emplace_back(nominal.model(), there.around(WithJointErrors<Chain>(there.model())));
  }
  if (stations > 0 && options.refuse_implausible && !options.errors.tool_per_station) {
    const auto& registered = frames.models.front().identified();
    for (std::size_t s = stations; s < sets.size(); ++s)
      if (sets[s].reflector == sets.front().reflector)
        require_plausible_set(ArmGeometry(registered.around(registered.chain())), sets[s]);
  }

  const double began = steady_seconds();
  const auto identified = [&](const IdentifyOptions& of_geometry) {
    const auto last = sets.begin() + static_cast<std::ptrdiff_t>((std::max<std::size_t>)(1, stations));
    return identified_from(nominal, {sets.begin(), last}, of_geometry, options.sensors, solver,
                           options.errors.tool_per_station);
  };
  Identified<Chain> geometry = identified(options.geometry);
  if (options.errors.prior != nullptr && geometry.status == IdentifyStatus::underdetermined)
    geometry = identified(frames_alone);  // an earlier calibration knows the rest
  if (options.refuse_implausible) require_usable(geometry, "identifying the geometry");
  FittedErrorModel<Chain> errors =
      fit_error_model(geometry, measured, options.errors, options.sensors, options.search, options.fit.executor);
  const double seconds = steady_seconds() - began;

  if (geometry.links_as_designed) {
    StagedModels<Chain>& of_links = errors.stages.front();
    of_links.included = false;
    frames.models.assign(of_links.models.begin(),
                         of_links.models.begin() + static_cast<std::ptrdiff_t>(frames.models.size()));
  }
  if (stations > 0) errors.stages.insert(errors.stages.begin(), std::move(frames));
  Calibration<Chain> out{std::move(geometry), std::move(errors)};
  out.fit_seconds = seconds;
  out.sensors = options.sensors;
  return out;
}

/// Training rows that are outliers beside the fitted model.
template <class Chain>
std::vector<OutlyingRow> outlying_rows(const FittedErrorModel<Chain>& errors,
                                       const Measurements<Chain::dof>& measured) {
  std::vector<OutlyingRow> out;
  for (std::size_t s = 0; s < measured.poses().size(); ++s) {
    // where the noise of a visit explains every error, there is no need to ask how well the unknowns are known
    const VectorX by_noise = predicted_errors<Chain>(errors, s, measured.poses()[s], nullptr, false).normalised;
    if (std::all_of(by_noise.begin(), by_noise.end(), [](double factor) { return factor <= least_outlier; })) continue;
    const PredictedErrors predicted = predicted_errors(errors, s, measured.poses()[s]);
    for (OutlyingRow& one : outlying_rows(measured.sets()[s], s, predicted.errors, predicted.normalised))
      out.push_back(std::move(one));
  }
  return out;
}

}  // namespace detail

/// Calibrates an arm: leaves training rows out that are outliers, registers every station, identifies geometry and
/// frames, fits geometry, frames and joint errors together, and learns the remainder. Whatever leave-one-out errors do
/// not support is left out.
///
///     calibrate(arm, poses);                                       // one data set
///     calibrate(arm, Measurements<6>(poses).add(wire), {.sensors = {.loss = Loss::cauchy}});
/// @param arm      as designed; its frames are where base and tool are assumed, and stay where they are known
/// @param measured of any kinds: geometry and frames are identified from poses, or from the first set if there are
///                 none; the error model has all of them
/// @param options  of all steps
/// @throws std::invalid_argument on an unusable option, no measurements, or touches without poses
/// @throws CalibrationFailure for data that do not fit the arm or do not support a calibration, with the reason, unless
///         `refuse_implausible` is off
template <NominalArm Arm>
Calibration<ChainOf<Arm>> calibrate(const Arm& arm, const Measurements<ChainOf<Arm>::dof>& measured,
                                    const CalibrateOptions& options = {}) {
  using Chain = ChainOf<Arm>;
  constexpr int N = Chain::dof;
  const Framed<Chain> nominal = in_frames(arm);
  demand(!measured.sets().empty(), "calibrate: no measurements");
  options.errors.validate();
  options.sensors.validate();

  std::vector<OutlyingRow> outliers;
  Index rows = 0;
  const std::vector<MeasuredSet> as_stated = measured.sets(options.sensors);
  for (std::size_t s = 0; s < measured.poses().size(); ++s) {
    rows += measured.poses()[s].size();
    for (OutlyingRow& one : detail::outlying_rows(ArmGeometry(nominal), as_stated[s], s))
      outliers.push_back(std::move(one));
  }
  const bool leave_out = !options.keep_outliers;
  if (leave_out) detail::require_few(outliers, rows);
  CalibrateOptions of_fit = options;
  of_fit.keep_outliers = options.keep_outliers && !outliers.empty();
  const auto kept_rows = [&] {
    return leave_out && !outliers.empty() ? detail::without_rows(measured, outliers) : measured;
  };
  Measurements<N> kept = kept_rows();
  Calibration<Chain> out = detail::fitted(nominal, kept, of_fit);
  std::vector<OutlyingRow> more = detail::outlying_rows(out.errors, kept);
  if (!more.empty()) {
    for (OutlyingRow& one : more) {
      const std::size_t s = one.station;
      if (leave_out)
        one.row = detail::other_rows(outliers, s, measured.poses()[s].size())[static_cast<std::size_t>(one.row)];
    }
    for (OutlyingRow& one : more)
      if (std::none_of(outliers.begin(), outliers.end(),
                       [&](const OutlyingRow& known) { return known.station == one.station && known.row == one.row; }))
        outliers.push_back(std::move(one));
    if (leave_out) {
      detail::require_few(outliers, rows);
      kept = kept_rows();
      out = detail::fitted(nominal, kept, of_fit);
    }
  }
  for (const Dataset<N>& all : measured.poses()) out.fitted_rows.add({all.joints(), all.positions()});
  out.outliers = std::move(outliers);
  out.outliers_kept = options.keep_outliers;
  const std::vector<Dataset<N>>& poses = kept.poses();
  if (!poses.empty()) detail::learn_remainders<Chain>(out, poses, options.remainder, options.fit);

  std::vector<double> residuals;
  out.oriented = options.sensors.use_orientations && !poses.empty();
  for (std::size_t s = 0; s < poses.size(); ++s) {
    out.poses += poses[s].size();
    out.oriented = out.oriented && poses[s].has_orientations();
    const VectorX e = detail::visited_errors(out.errors.models()[s], poses[s]);
    residuals.insert(residuals.end(), e.begin(), e.end());
  }
  const std::vector<MeasuredSet> sets = kept.sets(options.sensors);
  JointRows<N> joints(kept.size(), N);
  Index at = 0;
  for (const MeasuredSet& set : sets) {
    joints.middleRows(at, set.size()) = set.joints;
    at += set.size();
  }
  for (std::size_t s = poses.size(); s < sets.size(); ++s)
    out.others.push_back(detail::fitted_set(out.errors.models()[s], sets[s]));
  const MotorAngles motors(options.errors.controller);
  out.coverage = JointCoverage<N>::covering(joints, motors);
  for (int i = 0; i < N; ++i)
    out.coverage.periodic[static_cast<std::size_t>(i)] =
        nominal.model().row(motors.row_of(i)).joint == JointType::revolute;
  if (!residuals.empty())
    out.median_error =
        ErrorStatistics::of(Eigen::Map<const VectorX>(residuals.data(), static_cast<Index>(residuals.size()))).median;
  return out;
}

/// Something else than an arm is refused in a sentence.
template <class Arm, class... More>
  requires(!NominalArm<Arm>)
void calibrate(const Arm&, const More&...) {
  static_assert(NominalArm<Arm>, "calibrate takes an arm as designed: a Robot, a DhChain, or a Framed DhChain");
}

}  // namespace vernier
