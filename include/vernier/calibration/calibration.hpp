// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A calibrated arm: every step of the pipeline with its result.

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/calibration/detail/state_of_row.hpp"
#include "vernier/calibration/fitted_set.hpp"
#include "vernier/calibration/outlying_row.hpp"
#include "vernier/calibration/stage_errors.hpp"
#include "vernier/compensation/cartesian.hpp"
#include "vernier/compensation/learned_error.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/error_model/fitted_error_model.hpp"
#include "vernier/identification/identified.hpp"
#include "vernier/identification/in_one_frame.hpp"
#include "vernier/measurements/measured_set.hpp"
#include "vernier/measurements/row_fingerprints.hpp"

namespace vernier {

/// A position error learned on top of a model, and where it is valid.
template <int N>
struct LearnedRemainder {
  bool on_geometry;           ///< on geometry alone, not on the error model
  Learner learner;            ///< how it was learned
  LearnedError<N> predictor;  ///< of the position error [m], base frame
  JointCoverage<N> coverage;  ///< the measured joint ranges

  /// Whether nothing was learned: leave-one-out errors may prefer the mean alone.
  bool empty() const { return predictor.constant(); }
};

namespace detail {

/// An error in standard deviations of a covariance (Mahalanobis' distance).
VERNIER_API double normalised_error(const Vector3& error, const Matrix3& covariance);

/// How well a model fits the lengths of a set.
template <class Model>
FittedSet fitted_set(const Model& model, const MeasuredSet& set) {
  FittedSet out{set.name, set.kind(), set.size(), 0};
  SensedRows sensed;
  double sum = 0;
  for (Index i = 0; i < set.size(); ++i) {
    Isometry3 pose = model.pose(JointVector<Model::dof>(set.joints.row(i).transpose()));
    if (set.seen_from.rows() > 0)
      pose = model.pose(JointVector<Model::dof>(set.seen_from.row(i).transpose())).inverse() * pose;
    set.sense(i, pose, sensed);
    sum += sensed.residual.template head<3>().squaredNorm();
  }
  out.rms = std::sqrt(sum / static_cast<double>(set.size()));
  return out;
}

}  // namespace detail

/// Everything that `calibrate` found.
template <class C>
struct Calibration {
  /// The kind of chain.
  using Chain = C;
  /// Number of joints.
  static constexpr int dof = Chain::dof;

  Identified<Chain> geometry;  ///< frames and geometry alone, stations joined in the frame of the first
  FittedErrorModel<Chain>
      errors;  ///< every stage; that of `frames`, where there are poses, has stations of poses alone
  std::vector<RemainderTrial> trials{};             ///< learners that were tried on what the models leave
  std::vector<LearnedRemainder<dof>> remainders{};  ///< those of them that were learned from all poses
  std::optional<std::size_t> deployed_remainder{};  ///< which of them is deployed; none where cross-validation
                                                    ///< supports none
  JointCoverage<dof> coverage{};  ///< measured ranges of the joints, or of motors that err, and the range of validity:
                                  ///< these widened a little
  Index poses = 0;                ///< number of poses it was fitted to
  RowFingerprints fitted_rows{};  ///< of these, outliers included
  std::vector<FittedSet> others{};      ///< sets of measurements beside the poses
  bool oriented = false;                ///< whether orientations were used
  SensorModel sensors{};                ///< as given
  std::vector<OutlyingRow> outliers{};  ///< training rows that are outliers
  bool outliers_kept = false;           ///< whether it was fitted to them all the same
  double median_error = 0;              ///< median position error of the poses it was fitted to [m]
  double fit_seconds = 0;               ///< time from poses to error model

  /// What was learned and is deployed; null for nothing.
  const LearnedRemainder<dof>* deployed() const {
    return deployed_remainder ? &remainders[*deployed_remainder] : nullptr;
  }
  /// The stage that is deployed: the last that left-out poses support.
  StageName chosen() const {
    if (deployed() != nullptr) return learned_stage(deployed()->on_geometry, deployed()->learner);
    StageName out;
    for (const StagedModels<Chain>& staged : errors.stages)
      if (staged.included &&
          (staged.stage == Stage::frames ? geometry.links_as_designed : staged.stage > Stage::geometry) &&
          staged.stage < Stage::session)
        out = staged.stage;
    return out;
  }
  /// The model of a station that is deployed, without what was learned on it.
  /// @param station from 0
  const ErrorModel<Chain>& model(std::size_t station = 0) const {
    const bool on_geometry = deployed() != nullptr && deployed()->on_geometry;
    return (on_geometry ? errors.models(Stage::geometry) : errors.models())[station];
  }
};

namespace detail {

/// Poses as predicted under the payloads of the data, else as the model is.
template <class Chain>
std::vector<Isometry3> predicted_under_payload(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data) {
  std::vector<Isometry3> out;
  for (Index i = 0; i < data.size(); ++i) out.push_back(in_state_of(model, data, i, false).pose(data.joints(i)));
  return out;
}

/// Poses as predicted with their configurations of approach, moved by drift.
/// @param temperature whether each is predicted at its temperature, not at the mean one
template <class Chain>
std::vector<Isometry3> predicted_visits(const ErrorModel<Chain>& model, const Dataset<Chain::dof>& data,
                                        bool temperature, const SessionDrift& drift) {
  std::vector<Isometry3> out;
  const auto visit = [&](const ErrorModel<Chain>& now, Index i) {
    JointVector<Chain::dof> q = data.joints(i);
    if (const VectorX zeros = drift.joint_zeros(data.times()(i)); zeros.size() > 0) q += zeros;
    return drift.motion(data.times()(i)) * now.approached_from(configuration(data.previous(), i)).pose(q);
  };
  const bool thermal = temperature && model.thermal() != nullptr, varies = thermal || loaded_by(model, data);
  for (Index i = 0; i < data.size(); ++i)
    out.push_back(varies ? visit(in_state_of(model, data, i, thermal), i) : visit(model, i));
  return out;
}

/// Poses as they would have been measured at the mean temperature, in the middle of both directions of approach,
/// without drift.
/// @param drift one a station; none where there is none
template <class Chain>
std::vector<Dataset<Chain::dof>> static_poses(const std::vector<ErrorModel<Chain>>& models,
                                              std::span<const Dataset<Chain::dof>> stations,
                                              const std::vector<SessionDrift>& drift) {
  std::vector<Dataset<Chain::dof>> out;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const Dataset<Chain::dof>& data = stations[s];
    const std::vector<Isometry3> visited =
        predicted_visits(models[s], data, true, s < drift.size() ? drift[s] : SessionDrift{});
    PointRows positions = data.positions();
    for (Index i = 0; i < data.size(); ++i)
      positions.row(i) -=
          (visited[static_cast<std::size_t>(i)].translation() - models[s].position(data.joints(i))).transpose();
    out.push_back(Dataset<Chain::dof>(data.joints(), positions).without_approach());
  }
  return out;
}

/// Poses of all stations as the first one sees them, with its tool: the errors of each are those of its own model.
/// @param models one a station
template <class Chain>
Dataset<Chain::dof> in_first_frame(const std::vector<ErrorModel<Chain>>& models,
                                   std::span<const Dataset<Chain::dof>> stations) {
  std::vector<Dataset<Chain::dof>> seen;
  std::vector<Isometry3> bases(stations.size(), Isometry3::Identity());
  for (std::size_t s = 0; s < stations.size(); ++s) {
    const Dataset<Chain::dof>& data = stations[s];
    if (s == 0) {
      seen.push_back(data);
      continue;
    }
    const Matrix3 back = rotation(models[s].identified().base()).transpose();
    const Matrix3 turn = rotation(models.front().identified().base()) * back;
    PointRows positions(data.size(), 3);
    for (Index i = 0; i < data.size(); ++i) {
      const Vector3 error = models[s].position(data.joints(i)) - data.position(i);
      set_point(positions, i, Vector3(models.front().position(data.joints(i)) - turn * error));
    }
    seen.push_back(Dataset<Chain::dof>(data.joints(), positions).from(data.origin()));
  }
  return in_one_frame<Chain::dof>(seen, bases, false);
}

/// Errors of the models of a station at visits, in the frame of that station, and their sizes.
struct PredictedErrors {
  PointRows errors;      ///< n x 3: predicted - measured [m]
  VectorX normalised{};  ///< norms in standard deviations of the predicted ellipsoids, n
};

/// Errors of visits of one station, beside their predicted covariances: of the unknowns, of a visit, and of drift
/// beyond the session.
/// @param learned takes a position error that was learned off, in the base frame of the first station; null for none
/// @param of_unknowns whether the covariance has that of the unknowns; without it the normalised errors are too large
template <class Chain>
PredictedErrors predicted_errors(const FittedErrorModel<Chain>& errors, std::size_t station,
                                 const Dataset<Chain::dof>& data, const LearnedRemainder<Chain::dof>* learned = nullptr,
                                 bool of_unknowns = true) {
  const ErrorModel<Chain>& model = errors.models()[station];
  PredictedErrors out{PointRows(data.size(), 3), VectorX(data.size())};
  VectorX gates(data.size());
  for (Index i = 0; i < data.size(); ++i) gates(i) = model.gate(data.joints(i));
  const std::vector<Matrix6> covariances =
      errors.visit_covariances(data.joints(), gates, static_cast<int>(station), data.previous(), data.temperatures(),
                               data.payloads(), of_unknowns);
  const std::vector<Isometry3> poses = predicted_visits(model, data, true, {});
  const Matrix3 back = rotation(errors.model().identified().base()).transpose();
  const Matrix3 turn = rotation(model.identified().base()) * back;
  for (Index i = 0; i < data.size(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    Vector3 error = translation(poses[row]) - data.position(i);
    if (learned != nullptr)
      error -= turn * (learned->coverage(data.joints(i)) * learned->predictor.predict(data.joints(i)));
    Matrix3 covariance = covariances[row].template topLeftCorner<3, 3>();
    if (station < errors.drift.size() && !errors.drift[station].empty())
      covariance += errors.drift[station]
                        .covariance_beyond(data.times()(i), poses[row].translation(),
                                           model.pose_and_jacobian(data.joints(i)).jacobian)
                        .template topLeftCorner<3, 3>();
    set_point(out.errors, i, error);
    out.normalised(i) = normalised_error(error, covariance);
  }
  return out;
}

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/calibration/calibration.ipp"
#endif
