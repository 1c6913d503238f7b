#pragma once

/// @file
/// A fitted error model with what is known of it: what was decided and why, and how sure its predictions are.

#include <cmath>
#include <string>
#include <vector>

#include "vernier/identification/error_model.hpp"
#include "vernier/identification/error_model_design.hpp"

namespace vernier {

/// What leave-one-pose-out said of a block of joint errors.
struct BlockChoice {
  std::string name;    ///< `elastic` (gravity), `jointwise` (transmission); where that is in, `elastic_with_jointwise`
                       ///< (judged again) and `gears` (gear ratios, coupling)
  double without = 0;  ///< mean position error of poses left out, without the block [m]
  double with = 0;     ///< with it, as it was fitted [m]; what it would have been where it was not used
  bool used = false;   ///< whether it is in the model
  double tightness = 1;  ///< of its prior: 1 for the expected sizes, t for sizes divided by sqrt(t)
};

/// A predicted pose, and how well it is known.
struct PredictedPose {
  Isometry3 pose;                          ///< base_T_tool
  Eigen::Matrix<double, 6, 6> covariance;  ///< of one visit: position [m^2], then orientation [rad^2], base frame
  double gate = 1;                         ///< share of the joint-wise terms in it
};

/// An error model with all that is known of it.
template <class Chain>
struct FittedErrorModel {
  /// Number of joints.
  static constexpr int N = Chain::dof;

  std::vector<ErrorModel<Chain>> models{};    ///< one a station, those of distances last; they differ in their frames
  std::vector<ErrorModel<Chain>> elastic{};   ///< the same before transmission terms
  std::vector<ErrorModel<Chain>> geometry{};  ///< the same before all joint errors
  bool converged = false;                     ///< whether every solve ended where steps died away
  std::vector<BlockChoice> blocks{};          ///< what was decided, in order
  double position_sigma = 0;                  ///< of a visit, per component: sensor, and what the model lacks [m]; of a
                                              ///< distance where nothing else was measured
  double joint_sigma = 0;                     ///< of a visit, joints that do not repeat [rad]
  double orientation_sigma = 0;               ///< of a visit, per component [rad]; 0 for positions alone
  double fallback_error = 0;                  ///< mean position error of poses left out, without transmissions [m]
  detail::ErrorModelDesign<Chain> design;     ///< unknowns and where they ended
  MatrixX covariance{};                       ///< of all unknowns, in units of their sizes

  /// The model of the first, or only, station.
  const ErrorModel<Chain>& model() const { return models.front(); }

  /// What a transmission adds over some angles beyond its mean, which is the joint's zero; one value an angle [rad].
  struct JointFunction {
    VectorX value;  ///< mean taken off
    VectorX std;    ///< standard deviations of that
  };
  /// See `JointFunction`.
  /// @param joint  from 0
  /// @param angles n >= 1 values [rad]
  JointFunction transmission(int joint, const std::vector<double>& angles) const {
    require(!angles.empty(), "transmission: no angles");
    const auto& terms = models.front().arm().model().joint_errors().terms();
    const Index n = static_cast<Index>(angles.size());
    const Index count = size_of(terms.transmission[static_cast<std::size_t>(joint)]);
    if (count == 0) return {VectorX::Zero(n), VectorX::Zero(n)};
    const Index first = terms.transmission_begin(joint) - terms.few();
    MatrixX rows(n, count);
    VectorX all;
    for (Index k = 0; k < n; ++k) {
      design.functions(JointVector<N>::Constant(angles[static_cast<std::size_t>(k)]), all);
      rows.row(k) = all.segment(first, count).transpose();
    }
    rows.rowwise() -= rows.colwise().mean().eval();
    const Index at = design.dense() + first;
    return {rows * design.steps().segment(at, count),
            (rows * covariance.block(at, at, count, count)).cwiseProduct(rows).rowwise().sum().cwiseMax(0).cwiseSqrt()};
  }

  /// Where the arm will be at q, with the covariance of parameters, joint-wise coefficients and repeatability.
  /// @complexity O(unknowns^2); allocates
  PredictedPose predicted(const JointVector<N>& q, int station = 0) const {
    const auto& model = models[static_cast<std::size_t>(station)];
    detail::PoseRows at;
    const detail::Rows6 rows = design.rows(station, q, at);
    PredictedPose out{model.pose(q), rows * covariance * rows.transpose(), model.gate(q)};
    out.covariance += joint_sigma * joint_sigma * at.joint * at.joint.transpose();
    if (out.gate < 1)  // errors that the terms held back would have taken off
      out.covariance.diagonal().template head<3>().array() +=
          std::pow((1 - out.gate) * fallback_error / 1.6, 2);  // a mean norm is 1.6 sigma of a component
    out.covariance.diagonal().template head<3>().array() += position_sigma * position_sigma;
    out.covariance.diagonal().template tail<3>().array() += orientation_sigma * orientation_sigma;
    return out;
  }
};

}  // namespace vernier
