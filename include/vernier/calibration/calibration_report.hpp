// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The assessment of a calibration on held-out poses, whatever the arm: figures, tables and sentences are made of it.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vernier/calibration/fitted_set.hpp"
#include "vernier/calibration/outlying_row.hpp"
#include "vernier/calibration/stage_errors.hpp"
#include "vernier/error_model/joint_spectrum.hpp"
#include "vernier/evaluation/mean_interval.hpp"
#include "vernier/identification/identification_report.hpp"
#include "vernier/least_squares/loss.hpp"

namespace vernier {

/// One joint.
struct JointReport {
  bool revolute = true;                                      ///< its angles are in rad, else in m
  std::vector<double> held_out{};                            ///< joint values of the held-out poses [rad, m]
  std::vector<std::pair<double, double>> measured_ranges{};  ///< as they are [rad, m]
  std::vector<std::pair<double, double>> valid_ranges{};     ///< these widened a little, within the limits [rad, m]
  std::vector<double> angle{};                               ///< over the measured ranges [rad, m]
  VectorX transmission;                      ///< what the transmission adds there, mean subtracted [rad]
  VectorX transmission_std;                  ///< its standard deviation [rad]
  std::vector<HarmonicEstimate> spectrum{};  ///< of the transmission; empty where it has none
  std::vector<HarmonicEstimate> lines{};     ///< its orders that exceed noise, the largest first
  JointDrive drive{};                        ///< gear and encoder, as far as they were stated
  /// The joint as a formula of the controller's joints, e.g. -J2 - J3; empty where it is one of them as it is.
  std::string formula{};

  /// That formula in brackets, to follow the joint's number; empty without one.
  std::string bracketed_formula() const { return formula.empty() ? "" : " (" + formula + ")"; }
};

/// A weakly determined parameter, and poses that would determine it.
struct PoseAdvice {
  std::string parameter;                 ///< its name
  ParameterKind kind;                    ///< length [m] or angle [rad]
  double std_now = 0;                    ///< its standard deviation
  double std_then = 0;                   ///< the same after the poses were measured
  std::vector<VectorX> poses{};          ///< joint values of helpful poses, of the controller's joints [rad, m]
  std::vector<JointType> joint_types{};  ///< types of those joints
};

/// What a calibration says of payload.
struct FittedPayload {
  double mean = 0;         ///< mass that the arm carried on average [kg]
  bool estimated = false;  ///< whether there were several payloads, so that the effect of another one is known
};

/// A direction of gravity that was estimated.
struct EstimatedDown {
  Vector3 direction;  ///< in the base frame of the chain
  double std = 0;     ///< standard deviation [rad]
};

/// A calibration, assessed.
struct CalibrationReport {
  IdentificationReport identification;       ///< of the geometry
  std::vector<BlockChoice> blocks{};         ///< decisions on blocks of unknowns
  Index train_poses = 0;                     ///< poses it was fitted to
  std::vector<FittedSet> others{};           ///< measurements beside the poses
  std::vector<RemainderTrial> trials{};      ///< learners that were tried on what the models leave
  std::vector<StageErrors> stages{};         ///< of the held-out poses, in order
  std::vector<JointReport> joints{};         ///< one a joint
  std::vector<PoseAdvice> advice{};          ///< for the first weakly determined parameters
  std::vector<Index> held_out_poses{};       ///< number of the pose that each held-out row visits, from 0
  double block_error = 0;                    ///< of training poses that follow a path: mean error of blocks of
                                             ///< neighbours left out [m]; else 0
  VectorX gates;                             ///< share of the joint-wise terms at each held-out pose
  StageName chosen{};                        ///< the stage that is deployed
  std::optional<double> mean_temperature{};  ///< of the training poses [deg C], where the model changes with it
  std::optional<FittedPayload> payload{};    ///< where the poses state what the arm carried, and that has an effect
  std::optional<EstimatedDown> down{};       ///< where the direction of gravity was estimated
  std::optional<PriorTransfer> prior{};      ///< how much of an earlier calibration holds, where there was one
  std::vector<SessionDrift> drift{};         ///< of the base at each place; empty where the data do not support it
  double max_degradation = 0;     ///< largest excess of the chosen stage's error over that of geometry, inside the
                                  ///< range of validity [m]
  double ellipsoid_coverage = 0;  ///< share of held-out poses within their predicted 95 % ellipsoid
  bool oriented = false;          ///< whether orientations are used
  bool converged = true;          ///< whether the error model converged
  std::vector<OutlyingRow> outliers{};  ///< training rows that are outliers: all of them
  bool outliers_kept = false;           ///< whether the calibration was fitted to them all the same
  double median_error = 0;              ///< median position error of the training poses [m]
  Loss loss = Loss::huber;              ///< of the fit
  double fit_seconds = 0;               ///< time from poses to error model
  double leave_one_out_seconds = 0;     ///< of it, for leave-one-pose-out errors
  double evaluation_seconds = 0;        ///< time that the chosen stage takes for a pose and its Jacobian [s]
  VectorX normalised_errors{};          ///< of held-out poses, in standard deviations of their predicted ellipsoids
  VectorX left_out_errors{};            ///< of some training poses, each predicted by the model without it [m]
  std::vector<Index> left_out_rows{};   ///< which poses, counted over the stations

  /// Number of held-out rows.
  Index test_poses() const { return stages.empty() ? 0 : stages.front().position.size(); }
  /// Number of independent poses among them: rows that visit one pose count once.
  VERNIER_API Index independent_poses() const;
  /// Number of held-out poses outside the range of validity, the measured joint ranges widened a little.
  VERNIER_API Index extrapolated() const;
  /// The errors of a stage.
  /// @throws std::invalid_argument where it is not there
  VERNIER_API const StageErrors& stage(const StageName& name) const;
  /// Mean position error of the deployed stage at all held-out poses, independent ones, with its 95 % interval [m].
  /// @throws std::invalid_argument without held-out poses
  VERNIER_API MeanInterval held_out_mean() const;
  /// That so few poses were held out that errors say little; empty from ten poses on.
  VERNIER_API std::string few_poses() const;
  /// What a user must know before the calibration is used, a sentence each.
  VERNIER_API std::vector<std::string> remarks() const;
  /// How accurate the calibration is, and what it rests on: at most seven lines. All held-out poses come first, behind
  /// `few_poses`.
  VERNIER_API std::vector<std::string> verdict() const;
  /// What stands behind the verdict, a sentence each: decisions on blocks, ranges, drift, lines, advice.
  VERNIER_API std::vector<std::string> details() const;
  /// What to measure next, a sentence each: part of the details.
  VERNIER_API std::vector<std::string> next() const;
  /// Verdict, table of stages and fit of other measurements as text.
  VERNIER_API std::string summary() const;
  /// The summary, the identification and the details as text.
  VERNIER_API std::string full_summary() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/calibration_report.ipp"
#endif
