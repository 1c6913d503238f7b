// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Calibrated robots of what `calibrate`, `identify`, `identify_by_contacts` and `fit_error_model` found, with their
/// covariance.

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "vernier/calibration/calibration.hpp"
#include "vernier/error_model/arm_prior.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/error_model/geometry_estimate.hpp"
#include "vernier/identification/contact_report.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/io/calibrated_robot.hpp"
#include "vernier/kinematics/arm_geometry.hpp"

namespace vernier {

/// What a saved calibration is described by beside its model.
template <int N>
struct RobotInfo {
  std::string name = "robot";        ///< of the arm
  JointLimits<N> limits{};           ///< of the controller's joints
  std::string data_file{};           ///< name of the file of measured poses
  std::string date{};                ///< of the calibration
  std::string joints = "commanded";  ///< which joint values the data contain: commanded, or encoder
  double held_out_error = 0;         ///< mean position error of held-out poses [m]; 0: unknown
  std::string data_sha256{};         ///< of the bytes of those files, joined by commas; empty: unknown
  ControllerMap controller{};        ///< how the chain's joints follow from those of the controller
  /// Of the rows it was fitted to as files have them, where readings of a pose were joined; empty: those of the fit.
  RowFingerprints fitted_rows{};
};

namespace detail {

/// An identified geometry as a model without joint errors, with its covariance where there is one.
template <int N, class Convention>
CalibratedRobot<N, Convention> geometry_as_robot(const Calibrated<DhChain<N, Convention>>& arm,
                                                 const IdentificationReport& report, double position_sigma,
                                                 double orientation_sigma, const RobotInfo<N>& info,
                                                 Provenance provenance) {
  using Chain = DhChain<N, Convention>;
  const auto& identified = arm.identified();
  const ErrorModel<Chain> model(arm.nominal().model(), identified.around(WithJointErrors<Chain>(identified.model())));
  provenance.data_file = info.data_file;
  provenance.date = info.date;
  provenance.joints = info.joints;
  provenance.position_sigma = position_sigma;
  provenance.held_out_error = info.held_out_error;
  provenance.data_sha256 = info.data_sha256;
  const auto out = CalibratedRobot<N, Convention>(info.name, model, info.limits, std::move(provenance))
                       .with_controller(info.controller);
  if (report.covariance.size() == 0) return out;
  return out.with_estimate(geometry_estimate(ArmGeometry(identified), report, position_sigma, orientation_sigma));
}

}  // namespace detail

/// The arm of a calibration, with what was learned on top, as seen from one of its stations.
/// @param calibration as `calibrate` returns it
/// @param info name, limits and provenance
/// @param station from 0; with `ErrorModelOptions::tool_per_station` each has a tool of its own
/// @throws std::invalid_argument for a station that is not there
template <int N, class Convention>
CalibratedRobot<N, Convention> calibrated_robot(const Calibration<DhChain<N, Convention>>& calibration,
                                                const RobotInfo<N>& info = {}, std::size_t station = 0) {
  demand(station < calibration.errors.models().size(), "calibrated_robot: station ", station, " of ",
         calibration.errors.models().size());
  const VectorX& left_out = calibration.errors.left_out_errors;
  Provenance from{info.data_file,
                  calibration.poses,
                  info.date,
                  info.joints,
                  calibration.oriented ? "poses" : "positions",
                  calibration.errors.position_sigma,
                  left_out.size() > 0 ? std::sqrt(left_out.squaredNorm() / static_cast<double>(left_out.size())) : 0,
                  info.held_out_error,
                  info.data_sha256};
  from.fitted_rows = info.fitted_rows.empty() ? calibration.fitted_rows : info.fitted_rows;
  auto robot = CalibratedRobot<N, Convention>(info.name, calibration.model(station), info.limits, std::move(from))
                   .with_controller(info.controller);
  const LearnedRemainder<N>* learned = calibration.deployed();
  if (learned == nullptr || !learned->on_geometry)
    robot = robot.with_estimate(calibration.errors.of_station(static_cast<int>(station)));
  if (learned == nullptr) return robot;
  const Matrix3 back = rotation(calibration.model().identified().base()).transpose();
  const Matrix3 turn = rotation(calibration.model(station).identified().base()) * back;
  return robot.with_learned(station == 0 ? learned->predictor : learned->predictor.turned(turn), learned->coverage);
}

/// The arm of an identification from measured poses, with its covariance where they determine it.
template <int N, class Convention>
CalibratedRobot<N, Convention> calibrated_robot(const Identified<DhChain<N, Convention>>& found, Index poses,
                                                const RobotInfo<N>& info = {}) {
  const bool oriented = found.rotation_rms_after > 0;
  const double component = 1 / std::sqrt(3.0);
  return detail::geometry_as_robot(found.model, found, component * found.rms_after,
                                   component * found.rotation_rms_after, info,
                                   {.rows = poses, .measured = oriented ? "poses" : "positions"});
}

/// The arm of an identification from contacts, with its covariance; its base frame is that of the nominal arm.
template <int N, class Convention>
CalibratedRobot<N, Convention> calibrated_robot(const IdentifiedByContacts<DhChain<N, Convention>>& found,
                                                const RobotInfo<N>& info = {}) {
  Provenance from{.measured = "contacts"};
  for (const TouchedObject& object : found.objects) from.rows += object.touches;
  return detail::geometry_as_robot(found.model, found, found.rms_after, 0, info, std::move(from));
}

/// The arm of a fitted error model, with its covariance: as seen from its first station.
template <int N, class Convention>
CalibratedRobot<N, Convention> calibrated_robot(const FittedErrorModel<DhChain<N, Convention>>& fitted, Index poses,
                                                const RobotInfo<N>& info = {}) {
  const bool oriented = fitted.orientation_sigma > 0;
  return CalibratedRobot<N, Convention>(info.name, fitted.model(), info.limits,
                                        {.data_file = info.data_file,
                                         .rows = poses,
                                         .date = info.date,
                                         .joints = info.joints,
                                         .measured = oriented ? "poses" : "positions",
                                         .position_sigma = fitted.position_sigma,
                                         .held_out_error = info.held_out_error,
                                         .data_sha256 = info.data_sha256})
      .with_controller(info.controller)
      .with_estimate(fitted.first_station());
}

/// A calibrated arm as the prior of another calibration: of the same arm, or of another of its type.
/// @throws std::invalid_argument where its covariance was not kept
template <int N, class Convention>
ArmPrior arm_prior(const CalibratedRobot<N, Convention>& robot) {
  demand(robot.estimate() != nullptr, robot.name(), ": its model has no covariance; calibrate it again");
  return arm_prior(robot.name(), robot.model(), *robot.estimate());
}

}  // namespace vernier
