// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fitted error model: its arms, what was decided and why, and the covariance of its predictions.

#include <cmath>
#include <limits>
#include <vector>

#include "vernier/core/checked_joints.hpp"
#include "vernier/error_model/error_model.hpp"
#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// A predicted pose and its covariance.
struct PredictedPose {
  Isometry3 pose;      ///< base_T_tool
  Matrix6 covariance;  ///< of one visit: position [m^2], then orientation [rad^2], base frame
  double gate = 1;     ///< share of the joint-wise terms in it
};

/// The arms of a stage.
template <class Chain>
struct StagedModels {
  Stage stage;                            ///< up to which effects are in them
  bool included = true;                   ///< whether the data support the effect that the stage adds
  std::vector<ErrorModel<Chain>> models;  ///< one a station, those of poses first; they differ in their frames
};

/// An error model with everything that was estimated.
template <class Chain>
struct FittedErrorModel : ErrorModelEstimate {
  /// Number of joints.
  static constexpr int N = Chain::dof;

  /// In order: `frames`, which `calibrate` adds, then `geometry`, `elastic` and `jointwise` always. The last one has
  /// everything that the data support.
  std::vector<StagedModels<Chain>> stages{};

  /// Without arms.
  explicit FittedErrorModel(ErrorModelEstimate estimate) : ErrorModelEstimate(std::move(estimate)) {}

  /// The models with everything that the data support, one a station; they differ in their frames.
  const std::vector<ErrorModel<Chain>>& models() const { return stages.back().models; }
  /// The model of the first, or only, station.
  const ErrorModel<Chain>& model() const { return models().front(); }
  /// The models of a stage, one a station. If there is no such stage, those of the last one before it, or of the first.
  const std::vector<ErrorModel<Chain>>& models(Stage stage) const {
    std::size_t last = 0;
    for (std::size_t k = 0; k < stages.size(); ++k)
      if (stages[k].stage <= stage) last = k;
    return stages[last].models;
  }

  /// The predicted pose of the arm at q, with its covariance.
  /// @complexity O(unknowns^2); allocates
  PredictedPose predicted(const JointVector<N>& q, int station = 0) const {
    const auto& model = models()[static_cast<std::size_t>(station)];
    const double gate = model.gate(q);
    return {model.pose(q), visit_covariance(q, gate, station), gate};
  }
  /// The predicted pose at joint values whose number is known at run time.
  /// @throws std::invalid_argument on another number
  template <SizedAtRunTime Q>
  PredictedPose predicted(const Q& q, int station = 0) const {
    return predicted(detail::joint_vector<N>(q), station);
  }
  /// The prediction for an approach from known joint values.
  /// @param previous joint values from which q is approached [rad, m]; not finite where unknown
  /// @param q        joint values [rad, m]
  /// @param station  from 0
  /// @param temperature of the arm [deg C]; not finite where unknown
  PredictedPose predicted_from(const JointVector<N>& previous, const JointVector<N>& q, int station = 0,
                               double temperature = std::numeric_limits<double>::quiet_NaN()) const {
    const auto& model = models()[static_cast<std::size_t>(station)];
    const double gate = model.gate(q);
    const auto predict = [&](const auto& now) {
      return PredictedPose{now.approached_from(previous).pose(q),
                           visit_covariance(q, gate, station, previous, temperature), gate};
    };
    return std::isfinite(temperature) && model.thermal() != nullptr ? predict(model.at_temperature(temperature))
                                                                    : predict(model);
  }
  /// The predicted pose, approached from known joint values, where a number of them is known at run time.
  /// @throws std::invalid_argument on another number
  template <class P, class Q>
    requires(SizedAtRunTime<P> || SizedAtRunTime<Q>)
  PredictedPose predicted_from(const P& previous, const Q& q, int station = 0,
                               double temperature = std::numeric_limits<double>::quiet_NaN())
  const { return predicted_from(detail::fixed_vector<N>(previous), detail::fixed_vector<N>(q), station, temperature); }
};

}  // namespace vernier
