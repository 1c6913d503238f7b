#pragma once

/// @file
/// A fitted error model: its arms, what was decided and why, and the covariance of its predictions.

#include <cmath>
#include <limits>
#include <vector>

#include "vernier/error_model/error_model.hpp"
#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

/// A predicted pose and its covariance.
struct PredictedPose {
  Isometry3 pose;      ///< base_T_tool
  Matrix6 covariance;  ///< of one visit: position [m^2], then orientation [rad^2], base frame
  double gate = 1;     ///< share of the joint-wise terms in it
};

/// An error model with everything that was estimated.
template <class Chain>
struct FittedErrorModel : ErrorModelEstimate {
  /// Number of joints.
  static constexpr int N = Chain::dof;

  std::vector<ErrorModel<Chain>> models{};     ///< one a station, those of distances last; they differ in their frames
  std::vector<ErrorModel<Chain>> approach{};   ///< the same before tilts of joint frames; empty where there are none
  std::vector<ErrorModel<Chain>> jointwise{};  ///< the same before hysteresis, tilts and changes with temperature
  std::vector<ErrorModel<Chain>> elastic{};    ///< the same before transmission terms
  std::vector<ErrorModel<Chain>> geometry{};   ///< the same before all joint errors

  /// Without arms.
  explicit FittedErrorModel(ErrorModelEstimate estimate) : ErrorModelEstimate(std::move(estimate)) {}

  /// The model of the first, or only, station.
  const ErrorModel<Chain>& model() const { return models.front(); }

  /// The predicted pose of the arm at q, with its covariance.
  /// @complexity O(unknowns^2); allocates
  PredictedPose predicted(const JointVector<N>& q, int station = 0) const {
    const auto& model = models[static_cast<std::size_t>(station)];
    const double gate = model.gate(q);
    return {model.pose(q), visit_covariance(q, gate, station), gate};
  }
  /// The same, approached from known joint values.
  /// @param previous joint values from which q is approached [rad, m]; not finite where unknown
  /// @param q        joint values [rad, m]
  /// @param station  from 0
  /// @param temperature of the arm [deg C]; not finite where unknown
  PredictedPose predicted_from(const JointVector<N>& previous, const JointVector<N>& q, int station = 0,
                               double temperature = std::numeric_limits<double>::quiet_NaN()) const {
    const auto& model = models[static_cast<std::size_t>(station)];
    const double gate = model.gate(q);
    const auto predict = [&](const auto& now) {
      return PredictedPose{now.approached_from(previous).pose(q),
                           visit_covariance(q, gate, station, previous, temperature), gate};
    };
    return std::isfinite(temperature) && model.thermal() != nullptr ? predict(model.at_temperature(temperature))
                                                                    : predict(model);
  }
};

}  // namespace vernier
