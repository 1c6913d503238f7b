// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A fitted arm that drifts, tracked pose by pose.

#include <array>

#include "vernier/registration/reregister.hpp"

namespace vernier {

namespace detail {

/// Recursive least squares with forgetting towards the initial covariance.
/// @cite Ljung and Soderstrom 1983
class RecursiveEstimator {
 public:
  /// @param std        initial standard deviations
  /// @param forgetting weight of a sample after the next one, in (0, 1]
  VERNIER_API RecursiveEstimator(const VectorX& std, double forgetting);
  /// Covariance of the estimate.
  const MatrixX& covariance() const { return covariance_; }
  /// Processes whitened rows and residuals (measured minus modelled).
  /// @return the change of the estimate
  VERNIER_API VectorX update(const MatrixX& rows, const VectorX& residual);

 private:
  VectorX start_;  // variances
  MatrixX covariance_;
  double forgetting_;
};

/// Initial standard deviations of what an update estimates.
VERNIER_API VectorX initial_std(const FrameUpdate& update, const ReregisterOptions& options,
                                const std::array<double, 2>& sizes);

/// Whitened rows and residual of one measured pose, its orientation where `oriented`.
VERNIER_API void whitened_rows(const FrameUpdate& update, const SensorModel& sensors, const Isometry3& modelled,
                               const double* jacobian, const Isometry3& measured, bool oriented, MatrixX& rows,
                               VectorX& residual);

}  // namespace detail

/// Tracks a drifting arm pose by pose: recursive least squares on base, joint zeros or tool, with forgetting. It does
/// not test for contradictions as `reregister` does. Approach and temperature are not known to it: the arm is that of
/// the middle of both directions at the model's temperature, see `ErrorModel::at_temperature`.
/// @cite Ljung and Soderstrom 1983
template <class Chain>
class RecursiveCalibration {
 public:
  /// Number of joints.
  static constexpr int N = Chain::dof;

  /// @param model      where to start
  /// @param options    what drifts; of its priors that of the joint zeros is used
  /// @param sensors    accuracy of the measurements
  /// @param forgetting weight of a pose after the next one, in (0, 1]: 0.98 remembers about 50 poses
  /// @param sizes      initial standard deviations: of lengths (first) and angles (second) [m, rad]
  RecursiveCalibration(const ErrorModel<Chain>& model, const ReregisterOptions& options,
                       const SensorModel& sensors = {}, double forgetting = 0.98,
                       std::array<double, 2> sizes = {1e-3, 1e-3})
      : model_(model),
        sensors_(sensors),
        update_{options.base, options.offsets, options.tool, N},
        estimator_(detail::initial_std(update_, options, sizes), forgetting) {}

  /// The arm as presently estimated.
  const ErrorModel<Chain>& model() const { return model_; }
  /// Covariance of what drifts: base twist, joint zeros, tool twist, those estimated [m, rad].
  const MatrixX& covariance() const { return estimator_.covariance(); }

  /// Processes a measured position.
  void update(const JointVector<N>& q, const Vector3& position) {
    process(q, rigid_motion(Matrix3::Identity(), position), false);
  }
  /// Processes a measured pose.
  void update(const JointVector<N>& q, const Isometry3& pose) { process(q, pose, true); }

 private:
  void process(const JointVector<N>& q, const Isometry3& measured, bool oriented) {
    const PoseAndJacobian<N> at = model_.pose_and_jacobian(q);
    MatrixX rows;
    VectorX residual;
    detail::whitened_rows(update_, sensors_, at.pose, at.jacobian.data(), measured, oriented, rows, residual);
    const FrameMotion by = update_.motion(estimator_.update(rows, residual));
    model_ = model_.moved(by.base, JointVector<N>(by.offsets), by.tool);
  }

  ErrorModel<Chain> model_;
  SensorModel sensors_;
  detail::FrameUpdate update_;
  detail::RecursiveEstimator estimator_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/registration/recursive_calibration.ipp"
#endif
