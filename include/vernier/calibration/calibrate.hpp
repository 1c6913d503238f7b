#pragma once

/// @file
/// The calibration pipeline: from measurements to everything known of a real arm.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/calibration/calibration.hpp"
#include "vernier/calibration/detail/plausibility.hpp"
#include "vernier/calibration/learn_remainders.hpp"
#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/error_model/fit_error_model.hpp"
#include "vernier/evaluation/position_errors.hpp"
#include "vernier/identification/identify.hpp"
#include "vernier/identification/in_one_frame.hpp"
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
  bool refuse_implausible = true;    ///< throw for data that do not fit the arm, or do not support a calibration
  std::string arm_name = "the arm";  ///< how messages name the arm
};

/// Calibrates an arm: registers every station, identifies geometry and frames, fits geometry, frames and joint errors
/// together, and learns the remainder. Whatever leave-one-out errors do not support is left out.
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
  const std::vector<Dataset<N>>& poses = measured.poses();
  demand(!measured.sets().empty(), "calibrate: no measurements");
  options.errors.validate();
  options.sensors.validate();
  const std::vector<MeasuredSet> sets = measured.sets(options.sensors);
  const GeometrySolver solver = options.solver ? options.solver : GeometrySolver(own_solver);

  IdentifyOptions frames_alone = options.geometry;
  frames_alone.geometry = false;
  StagedModels<Chain> frames{Stage::frames, true, {}};
  std::vector<Isometry3> bases;
  for (std::size_t s = 0; s < poses.size(); ++s) {
    const auto registered = detail::identified_from(nominal, sets[s], frames_alone, options.sensors, solver);
    if (options.refuse_implausible) {
      detail::require_plausible(ArmGeometry(nominal), sets[s], registered.rms_after, options.arm_name);
      detail::require_usable(registered, "registering the frames");
    }
    const Framed<Chain>& there = registered.model.identified();
    frames.models.emplace_back(nominal.model(), there.around(WithJointErrors<Chain>(there.model())));
    bases.push_back(there.base());
  }
  if (!poses.empty() && options.refuse_implausible && !options.errors.tool_per_station) {
    const auto& registered = frames.models.front().identified();
    for (std::size_t s = poses.size(); s < sets.size(); ++s)
      detail::require_plausible_set(ArmGeometry(registered.around(registered.chain())), sets[s]);
  }

  const double began = detail::steady_seconds();
  const auto identified = [&](const IdentifyOptions& of_geometry) {
    const auto from = [&](const MeasuredSet& set) {
      return detail::identified_from(nominal, set, of_geometry, options.sensors, solver);
    };
    if (poses.empty()) return from(sets.front());
    const Measurements<N> joined(in_one_frame<N>(poses, bases, options.sensors.use_orientations));
    return from(joined.sets(options.sensors).front());
  };
  Identified<Chain> geometry = identified(options.geometry);
  if (options.errors.prior != nullptr && geometry.status == IdentifyStatus::underdetermined)
    geometry = identified(frames_alone);  // an earlier calibration knows the rest
  if (options.refuse_implausible) detail::require_usable(geometry, "identifying the geometry");
  FittedErrorModel<Chain> errors =
      fit_error_model(geometry, measured, options.errors, options.sensors, options.search, options.fit.executor);
  const double seconds = detail::steady_seconds() - began;

  if (!poses.empty()) errors.stages.insert(errors.stages.begin(), std::move(frames));
  Calibration<Chain> out{std::move(geometry), std::move(errors)};
  out.fit_seconds = seconds;
  out.sensors = options.sensors;
  if (!poses.empty()) detail::learn_remainders<Chain>(out, poses, options.remainder, options.fit);

  std::vector<double> residuals;
  out.oriented = options.sensors.use_orientations && !poses.empty();
  for (std::size_t s = 0; s < poses.size(); ++s) {
    out.poses += poses[s].size();
    out.oriented = out.oriented && poses[s].has_orientations();
    const VectorX e = detail::visited_errors(out.errors.models()[s], poses[s]);
    residuals.insert(residuals.end(), e.begin(), e.end());
  }
  JointRows<N> joints(measured.size(), N);
  Index at = 0;
  for (const MeasuredSet& set : sets) {
    joints.middleRows(at, set.size()) = set.joints;
    at += set.size();
  }
  for (std::size_t s = poses.size(); s < sets.size(); ++s)
    out.others.push_back(detail::fitted_set(out.errors.models()[s], sets[s]));
  out.coverage = JointCoverage<N>::covering(joints);
  for (int i = 0; i < N; ++i)
    out.coverage.periodic[static_cast<std::size_t>(i)] = nominal.model().row(i).joint == JointType::revolute;
  if (!residuals.empty()) {
    const Eigen::Map<const VectorX> e(residuals.data(), static_cast<Index>(residuals.size()));
    out.median_error = ErrorStatistics::of(e).median;
    out.outliers = (e.array() > 8 * out.median_error).count();
  }
  return out;
}

/// Something else than an arm is refused in a sentence.
template <class Arm, class... More>
  requires(!NominalArm<Arm>)
void calibrate(const Arm&, const More&...) {
  static_assert(NominalArm<Arm>, "calibrate takes an arm as designed: a Robot, a DhChain, or a Framed DhChain");
}

}  // namespace vernier
