// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Re-registration of a fitted arm that was moved, remounted or has drifted: its frames and joint zeros are estimated
/// again, everything else is kept.

#include <algorithm>
#include <string>
#include <vector>

#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/measurements/measurements.hpp"
#include "vernier/registration/detail/frame_fit.hpp"

namespace vernier {

/// What is estimated again.
struct ReregisterOptions {
  bool base = true;                ///< the arm, or the sensor, was moved
  bool tool = false;               ///< the tool was remounted, or is another one
  bool offsets = false;            ///< joint zeros
  double offset_prior_std = 1e-3;  ///< expected change of a joint zero [rad, m]: a prior, so that few poses suffice
  double tool_position_prior_std = 3e-3;  ///< expected motion of the tool point, where the tool is freed [m], a prior
                                          ///< as well; infinite: another tool, of which nothing is known. Its
                                          ///< rotation is then held where only positions were measured
  double tool_rotation_prior_std = 5e-3;  ///< expected rotation of the tool, likewise [rad]
  /// Measured orientations are taken to be turned against the tool where that explains more than chance does: a
  /// chi-squared of three values, which chance exceeds once in a thousand times. Infinite: never.
  double contradiction_threshold = 16.3;
  /// Position error that the calibration states for poses it was not fitted to [m]; 0: unknown. Ten times as much left
  /// after registration gets a remark.
  double expected_error = 0;

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

namespace detail {

/// A residual after registration that no error of the calibration explains, in a sentence; empty for none.
/// @param left     position error after registration [m]
/// @param expected that of the calibration at poses it was not fitted to [m]; 0: unknown
VERNIER_API std::string excess_remark(double left, double expected);
/// Poses outside the measured joint ranges, in a sentence; empty for none.
/// @param outside which of them
/// @param origin  where they stand in files
/// @param poses   number of all poses
VERNIER_API std::string outside_remark(const std::vector<Index>& outside, const RowOrigin& origin, Index poses);

}  // namespace detail

/// Outcome of a re-registration, whatever the arm.
struct ReregistrationReport {
  bool determined = false;               ///< whether the poses, with the priors, determine everything that is estimated
  bool converged = false;                ///< whether the iteration converged
  double rms_before = 0;                 ///< position error with the frames of before [m]
  double rms_after = 0;                  ///< position error with the new ones [m]
  FrameMotion motion{};                  ///< how the arm was moved
  ReregisterOptions estimated{};         ///< what was estimated
  std::vector<JointType> joint_types{};  ///< of the arm
  /// Standard deviations: base twist (6), joint zeros (N), tool twist (6), those estimated [m, rad]. They count what
  /// was held as uncertain as its prior.
  VectorX change_std{};
  /// Standard deviation of positions with which they were weighted, per component [m]: estimated from the residuals, so
  /// that it contains the model's own error, and at least that of the sensor.
  double position_sigma = 0,
         orientation_sigma = 0;  ///< the same of orientations [rad]; 0 where they are not used
  /// What the poses do not determine of the tool, so that it was held where it was: `the position of the tool along
  /// (0.00, 0.00, 1.00) of its frame`. Held is that of which more than half of the prior's standard deviation is left.
  std::vector<std::string> held{};
  /// Whether orientations contradict positions and were taken to be turned by `motion.probe`.
  bool probe_turned = false;
  Index poses = 0;                      ///< number of poses
  std::vector<Index> outside{};         ///< those outside the measured joint ranges of the model
  RowOrigin origin{};                   ///< where the poses stand in files
  double contradiction = 0;             ///< the statistic behind, to be compared with `contradiction_threshold`
  Vector3 probe_std = Vector3::Zero();  ///< standard deviations of `motion.probe` [rad]

  /// What is to be known before the result is used, a sentence each: contradictions, what was held, a tool that moved
  /// further than expected, poses outside the measured joint ranges, a residual far above the expected error.
  VERNIER_API std::vector<std::string> remarks() const;
  /// What was estimated and how it changed, a line each [mm, mrad]; then the remarks.
  VERNIER_API std::string summary() const;
};

/// A re-registered arm.
template <class Chain>
struct Reregistered : ReregistrationReport {
  ErrorModel<Chain> model;  ///< in its new frames
};

namespace detail {

/// Mean rotation of the measured orientations against the modelled ones, in the tool frame [rad].
VERNIER_API Vector3 probe_rotation(const std::vector<Isometry3>& modelled, const std::vector<Matrix3>& measured);

/// Estimates how an arm was moved.
VERNIER_API FrameMotion reregister(const MovedPoses& evaluate, const MeasuredSet& data,
                                   const ReregisterOptions& options, const SensorModel& sensors,
                                   ReregistrationReport& report);

}  // namespace detail

/// Estimates base, tool or joint zeros of a fitted arm again, from a handful of poses; everything else is kept.
///
/// Where positions and orientations contradict each other by a constant rotation of the tool frame (a remounted probe),
/// that rotation is estimated as well and reported, for orientations alone: the model's tool stays as it was.
/// @param model    as fitted, wherever it stood then
/// @param measured n >= 1 poses from where it stands now, of one station; temperatures count if the model changes with
///                 them
/// @param options  what is estimated
/// @param sensors  accuracy of the poses, the least that residuals are taken for. They are weighted by squares,
/// whatever
///                 its loss; its `joint_sigma` is not used
/// @throws std::invalid_argument on no data or an unusable option
template <class Chain>
Reregistered<Chain> reregister(const ErrorModel<Chain>& model, const Measurements<Chain::dof>& measured,
                               const ReregisterOptions& options = {}, const SensorModel& sensors = {}) {
  constexpr int N = Chain::dof;
  const Dataset<N>& data = detail::only_poses(measured, "reregister");
  const auto moved = [&](const FrameMotion& by) { return model.moved(by.base, JointVector<N>(by.offsets), by.tool); };
  const auto evaluate = [&](const FrameMotion& motion, std::vector<Isometry3>& poses, MatrixX& jacobians) {
    const ErrorModel<Chain> now = moved(motion);
    poses.resize(static_cast<std::size_t>(data.size()));
    jacobians.resize(6, N * data.size());
    const bool warm = now.thermal() != nullptr && data.temperatures().size() > 0;
    const bool loaded = data.payloads().rows() > 0;
    for (Index i = 0; i < data.size(); ++i) {
      const auto visit = [&](const ErrorModel<Chain>& arm) {
        return arm.approached_from(configuration(data.previous(), i)).pose_and_jacobian(data.joints(i));
      };
      const PoseAndJacobian<N> at =
          loaded
              ? visit(
                    (warm ? now.at_temperature(data.temperatures()(i)) : now).carrying(Payload::of(data.payloads(), i)))
          : warm ? visit(now.at_temperature(data.temperatures()(i)))
                 : visit(now);
      poses[static_cast<std::size_t>(i)] = at.pose;
      std::copy_n(at.jacobian.data(), 6 * N, jacobians.data() + 6 * N * i);
    }
  };
  const auto types = model.nominal().chain().joint_types();
  ReregistrationReport report;
  const FrameMotion found =
      detail::reregister(evaluate, measured.sets().front().with(sensors), options, sensors, report);
  report.joint_types = {types.begin(), types.end()};
  report.origin = data.origin();
  for (Index i = 0; i < data.size(); ++i)
    if (model.gate(data.joints(i)) < 1) report.outside.push_back(i);
  return {std::move(report), moved(found)};
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/registration/reregister.ipp"
#endif
