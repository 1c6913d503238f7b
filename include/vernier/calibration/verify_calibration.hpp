// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The yearly check: whether a calibration still holds, from a few fresh poses.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/calibration/detail/state_of_row.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/error_model/error_model_estimate.hpp"
#include "vernier/measurements/row_fingerprints.hpp"
#include "vernier/registration/reregister.hpp"

namespace vernier {

/// How a calibration is checked.
struct VerifyOptions {
  bool base = true;     ///< the sensor was set up anew, or the arm moved: the base is registered first
  bool tool = false;    ///< the tool was remounted: it is registered, too
  double level = 0.05;  ///< probability of a false alarm about an arm that has not changed, in (0, 1)
  /// Largest mean position error that is accepted [m]. Without one a calibration is valid as long as no change is
  /// significant; with one, as long as the upper end of the 95 % interval of the mean error does not exceed it.
  std::optional<double> accept{};
  SensorModel sensors{};  ///< of the check; a sensor worse than that of the calibration adds its noise
  /// Position error that the calibration states for poses it was not fitted to [m]; 0: unknown. Ten times as much left
  /// after registration is remarked upon.
  double expected_error = 0;
  bool fitted_poses = false;  ///< the poses are known to be those that the calibration was fitted to
  /// Poses that the calibration was fitted to. They are left out of the check, unless fewer than three others are left:
  /// then all are as `fitted_poses` says.
  RowFingerprints fitted_rows{};
  ControllerMap controller{};  ///< after whose joints the report names those of the chain

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

/// What a check says of one joint, or of one motor where motors err (`MotorAngles`).
struct JointCheck {
  bool determined = false;    ///< whether the poses tell its zero from what was registered
  double zero_change = 0;     ///< estimated change of its zero, everything else unchanged [rad, m]
  double zero_std = 0;        ///< standard deviation of that, the uncertainty of the calibration included
  double zero_p = 1;          ///< probability of a change as large by chance, this joint looked at alone
  double once_p = 1;          ///< the same of a change of its transmission once a turn: cosine and sine of its angle
  bool zero_changed = false;  ///< whether its zero is named as changed
  bool transmission_changed = false;  ///< whether its transmission is
};

/// The outcome of a check.
struct VerificationReport {
  bool valid = false;       ///< whether the calibration still holds, see `VerifyOptions::accept`
  bool consistent = false;  ///< whether no change is significant; all residuals together must be larger than their
                            ///< predicted median for a change to be named
  Index poses = 0;          ///< number of poses
  double chi_square = 0;    ///< of all residuals, whitened by their predicted covariance, less what was registered
  Index dof = 0;            ///< its degrees of freedom
  double p_value = 1;       ///< probability of a larger one by chance
  /// Probability that chance leaves changes of all joints together as small, measured by the residuals: nearly 0 for
  /// the poses of the fit, to which the joints were adapted.
  double closeness = 1;
  double explained = 0;                                ///< the most of `chi_square` that a change of one joint explains
  std::vector<JointCheck> joints{};                    ///< one a joint
  std::vector<JointType> joint_types{};                ///< of the arm
  std::optional<ReregistrationReport> registration{};  ///< how base and tool have moved, where they were registered
  VectorX as_fitted{};                                 ///< position errors in the frames of the calibration [m]
  VectorX errors{};                                    ///< the same after registration [m]
  VectorX rotations{};            ///< orientation errors then [rad]; empty where they were not used
  VectorX rotations_as_fitted{};  ///< in the frames of the calibration, likewise
  VectorX normalised{};           ///< position errors in standard deviations of their predicted ellipsoids
  Index known = 0;                ///< number of poses that were left out, see `VerifyOptions::fitted_rows`
  std::vector<Index> aside{};     ///< rows that contradict all others, left out of all tests
  RowOrigin origin{};             ///< where the rows stand in files
  double mean_error = 0;          ///< mean of `errors` but those aside [m]
  double mean_upper = 0;          ///< upper end of its 95 % interval by Student's t [m]
  VerifyOptions options{};        ///< as given

  /// A joint in words, from 0: its number, or its formula in joints of the controller.
  VERNIER_API std::string joint_name(std::size_t joint) const;
  /// One sentence: whether the calibration is still valid, and if not, what has changed.
  VERNIER_API std::string verdict() const;
  /// What to do, a sentence each.
  VERNIER_API std::vector<std::string> advice() const;
  /// Both, and a line a joint, as text [mm, mrad].
  VERNIER_API std::string summary() const;
};

namespace detail {

/// What a check needs of the arm, in its new frames: modelled poses, what was learned taken off, and what they depend
/// on.
struct VerificationInput {
  const MeasuredSet& data;                           ///< the measured poses
  const ErrorModelEstimate& estimate;                ///< of the arm where it stands now
  std::vector<Isometry3> poses;                      ///< as modelled, with their approach
  MatrixX jacobians;                                 ///< geometric Jacobians, 6 x joints each, side by side
  std::vector<Isometry3> poses_as_fitted;            ///< in the frames of the calibration
  VectorX gates;                                     ///< share of the joint-wise terms
  std::vector<JointType> joint_types;                ///< of the arm
  std::optional<ReregistrationReport> registration;  ///< where base or tool was registered
};
VERNIER_API VerificationReport verified(const VerificationInput& input, const VerifyOptions& options);
/// Of two readings of turned orientations, a turned probe and a change of a joint, the one that explains them.
/// @param probe with the rotation of the probe taken off
/// @param arm   without
VERNIER_API VerificationReport better_reading(VerificationReport probe, VerificationReport arm);

}  // namespace detail

/// Checks whether a calibration still holds. Base and, where asked for, tool are registered first. What is left is
/// compared with the covariance that the calibration itself predicts: of its parameters, which all poses share, and of
/// each visit. A chi-square of everything, and one of each joint's zero and of each joint's transmission once a turn,
/// are tested at the given level together (Bonferroni). Of several joints the one that explains most is named first,
/// and the others are tested again beside it. Orientations that are turned against the tool are taken to be those of a
/// turned probe, as `reregister` does, unless a change of one joint explains them as well.
///
/// The zero of a first joint that the base follows cannot be told from it and is not determined.
/// @param model    as calibrated
/// @param estimate what its calibration estimated, see `CalibratedRobot::estimate`
/// @param measured 3 to 1000 fresh poses, from one station
/// @param options  what was set up anew, the level, the accuracy asked for
/// @param learned  n x 3, the position error that was learned on top of the model at these poses, in its base frame
/// [m],
///                 taken off its positions; no rows for none
/// @throws std::invalid_argument for unusable options, too few or too many poses, or poses that do not determine the
/// registration
/// @complexity O(n u^2 + n^3) for u unknowns of the calibration
/// @cite Koch 1999
template <class Chain>
VerificationReport verify_calibration(const ErrorModel<Chain>& model, const ErrorModelEstimate& estimate,
                                      const Measurements<Chain::dof>& measured, const VerifyOptions& options = {},
                                      const PointRows& learned = PointRows(0, 3)) {
  constexpr int N = Chain::dof;
  options.validate();
  const Dataset<N>& data = detail::only_poses(measured, "verify_calibration");
  demand(data.size() >= 3, "verify_calibration: ", data.size(), " poses, at least 3 are needed");
  demand(learned.rows() == 0 || learned.rows() == data.size(), "verify_calibration: ", learned.rows(),
         " learned errors of ", data.size(), " poses");
  if (const auto fresh = options.fitted_rows.others(data.joints(), data.positions());
      static_cast<Index>(fresh.size()) < data.size()) {
    VerifyOptions of_fresh = options;
    of_fresh.fitted_rows = {};
    of_fresh.fitted_poses = fresh.size() < 3;
    if (of_fresh.fitted_poses) return verify_calibration(model, estimate, measured, of_fresh, learned);
    PointRows of_rows(learned.rows() > 0 ? static_cast<Index>(fresh.size()) : 0, 3);
    for (Index i = 0; i < of_rows.rows(); ++i) of_rows.row(i) = learned.row(fresh[static_cast<std::size_t>(i)]);
    VerificationReport out =
        verify_calibration(model, estimate, measured.with_poses({data.rows(fresh)}), of_fresh, of_rows);
    out.known = data.size() - static_cast<Index>(fresh.size());
    return out;
  }
  demand(data.size() <= 1000, "verify_calibration: ", data.size(),
         " poses, at most 1000 are taken: their covariance is dense");
  const auto types = model.nominal().chain().joint_types();
  const MeasuredSet set = measured.sets().front().with(options.sensors);
  const auto checked = [&](const ErrorModel<Chain>& now, std::optional<ReregistrationReport> registration) {
    const ErrorModelEstimate here = estimate.of_arm(FittedArm::of(now.identified()));
    detail::VerificationInput input{set, here, {}, {}, {}, {}, {types.begin(), types.end()}, std::move(registration)};
    input.jacobians.resize(6, N * data.size());
    input.gates.resize(data.size());
    const Matrix3 before_turn = rotation(model.identified().base()), back = before_turn.transpose(),
                  turn = rotation(now.identified().base()) * back;
    for (Index i = 0; i < data.size(); ++i) {
      const JointVector<N> q = data.joints(i), previous = configuration(data.previous(), i);
      const Vector3 error = learned.rows() > 0 ? point(learned, i) : Vector3(Vector3::Zero());
      const auto warm = [&](const ErrorModel<Chain>& arm) { return detail::in_state_of(arm, data, i); };
      const ErrorModel<Chain> arm = warm(now), before = warm(model);
      PoseAndJacobian<N> at = arm.approached_from(previous).pose_and_jacobian(q);
      Isometry3 then = before.approached_from(previous).pose(q);
      at.pose.translation() -= turn * error;
      then.translation() -= error;
      input.poses.push_back(at.pose);
      input.poses_as_fitted.push_back(then);
      std::copy_n(at.jacobian.data(), 6 * N, input.jacobians.data() + 6 * N * i);
      input.gates(i) = model.gate(q);
    }
    return detail::verified(input, options);
  };
  constexpr double largest_zero = 0.02;  // [rad]; more is no change of a joint
  if (!options.base && !options.tool) {
    VerificationReport stands = checked(model, {});
    if (!set.oriented()) return stands;
    std::vector<Isometry3> modelled;
    for (Index i = 0; i < data.size(); ++i)
      modelled.push_back(model.approached_from(configuration(data.previous(), i)).pose(data.joints(i)));
    ReregistrationReport probe{.determined = true, .converged = true, .estimated = {.base = false}};
    probe.motion.offsets = VectorX::Zero(N);
    probe.motion.probe = detail::probe_rotation(modelled, set.orientations());
    probe.joint_types = {types.begin(), types.end()};
    probe.poses = data.size();
    probe.rms_before = probe.rms_after =
        std::sqrt(stands.errors.squaredNorm() / static_cast<double>(stands.errors.size()));
    probe.probe_turned = true;
    VerificationReport turned = checked(model, probe);
    turned.registration->contradiction = stands.chi_square - turned.chi_square;
    if (turned.registration->motion.probe.norm() > largest_zero) return turned;
    return detail::better_reading(std::move(turned), std::move(stands));
  }
  ReregisterOptions free{.base = options.base, .tool = options.tool};
  const auto register_again = [&] {
    const auto found = reregister(model, data, free, options.sensors);
    demand(found.determined, "verify_calibration: the poses do not determine where the arm stands; measure more");
    return checked(found.model, static_cast<const ReregistrationReport&>(found));
  };
  VerificationReport out = register_again();
  if (!out.registration->probe_turned) return out;
  if (out.registration->motion.probe.norm() > largest_zero) return out;
  free.contradiction_threshold = std::numeric_limits<double>::infinity();
  return detail::better_reading(std::move(out), register_again());
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/verify_calibration.ipp"
#endif
