#pragma once

/// @file
/// A fitted arm that drifts, followed pose by pose.

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "vernier/identification/reregister.hpp"

namespace vernier {

/// Follows a drifting arm pose by pose: recursive least squares on base, joint zeros or tool, with forgetting.
/// @cite Ljung and Soderstrom 1983
template <class Chain>
class OnlineUpdate {
 public:
  /// Number of joints.
  static constexpr int N = Chain::dof;

  /// @param model      where to start
  /// @param options    what drifts, and how well it is measured
  /// @param forgetting weight of a pose after the next one, in (0, 1]: 0.98 remembers about 50 poses
  /// @param sizes      how far things may have gone [m, rad]: deviations of lengths (first) and angles (second)
  OnlineUpdate(const ErrorModel<Chain>& model, const ReregisterOptions& options, double forgetting = 0.98,
               std::array<double, 2> sizes = {1e-3, 1e-3})
      : model_(model),
        options_(options),
        change_{options.base, options.offsets, options.tool},
        forgetting_(forgetting) {
    options.validate();
    require(forgetting > 0 && forgetting <= 1, "OnlineUpdate: forgetting is ", forgetting, ", must lie in (0, 1]");
    require(sizes[0] > 0 && sizes[1] > 0, "OnlineUpdate: sizes must be positive");
    VectorX deviation(change_.size());
    Index at = 0;
    const auto twist = [&] {
      deviation.segment(at, 3).setConstant(sizes[0]);
      deviation.segment(at + 3, 3).setConstant(sizes[1]);
      at += 6;
    };
    if (options.base) twist();
    if (options.offsets) {
      deviation.segment(at, N).setConstant(options.offset_size);
      at += N;
    }
    if (options.tool) twist();
    start_ = deviation.cwiseAbs2();
    covariance_ = start_.asDiagonal();
  }

  /// The arm as it is believed to be now.
  const ErrorModel<Chain>& model() const { return model_; }
  /// How well what drifts is known: base twist, joint zeros, tool twist, those that drift [m, rad].
  const MatrixX& covariance() const { return covariance_; }

  /// Takes in a measured position.
  void update(const JointVector<N>& q, const Vector3& position) {
    const PoseAndJacobian<N> at = model_.pose_and_jacobian(q);
    take(change_.effect(at).template topRows<3>() / options_.position_sigma,
         (position - at.pose.translation()) / options_.position_sigma);
  }
  /// Takes in a measured pose.
  void update(const JointVector<N>& q, const Isometry3& pose) {
    const PoseAndJacobian<N> at = model_.pose_and_jacobian(q);
    MatrixX effect = change_.effect(at);
    effect.topRows<3>() /= options_.position_sigma;
    effect.bottomRows<3>() /= options_.orientation_sigma;
    Vector6 residual = pose_difference(pose, at.pose);
    residual.head<3>() /= options_.position_sigma;
    residual.tail<3>() /= options_.orientation_sigma;
    take(effect, residual);
  }

 private:
  void take(const MatrixX& rows, const VectorX& residual) {
    require(residual.allFinite(), "OnlineUpdate: a measured value is not finite");
    if (forgetting_ < 1) {  // towards what was known at the start: what is not excited is not forgotten without end
      const MatrixX one = MatrixX::Identity(start_.size(), start_.size());
      MatrixX information = forgetting_ * covariance_.ldlt().solve(one);
      information.diagonal() += (1 - forgetting_) * start_.cwiseInverse();
      covariance_ = information.ldlt().solve(one);
    }
    const MatrixX cross = covariance_ * rows.transpose();
    const Eigen::LDLT<MatrixX> inner(rows * cross + MatrixX::Identity(rows.rows(), rows.rows()));
    model_ = change_.apply(model_, cross * inner.solve(residual));
    covariance_ -= cross * inner.solve(cross.transpose());
    covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  }

  ErrorModel<Chain> model_;
  ReregisterOptions options_;
  detail::Adjustment<N> change_;
  double forgetting_;
  VectorX start_;
  MatrixX covariance_;
};

}  // namespace vernier
