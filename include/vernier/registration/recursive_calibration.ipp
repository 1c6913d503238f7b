#pragma once

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/registration/recursive_calibration.hpp"

namespace vernier::detail {

VERNIER_IMPL RecursiveEstimator::RecursiveEstimator(const VectorX& std, double forgetting)
    : start_(std.cwiseAbs2()), covariance_(MatrixX::Zero(std.size(), std.size())), forgetting_(forgetting) {
  require(forgetting > 0 && forgetting <= 1, "RecursiveCalibration: forgetting is ", forgetting,
          ", must lie in (0, 1]");
  covariance_.diagonal() = start_;
}

VERNIER_IMPL VectorX RecursiveEstimator::update(const MatrixX& rows, const VectorX& residual) {
  require(residual.allFinite(), "RecursiveCalibration: a measured value is not finite");
  if (forgetting_ < 1) {  // towards the initial covariance: what is not excited does not grow without bound
    cholesky(covariance_);
    MatrixX information = forgetting_ * inverse_from_cholesky(covariance_);
    information.diagonal() += (1 - forgetting_) * start_.cwiseInverse();
    cholesky(information);
    covariance_ = inverse_from_cholesky(information);
  }
  MatrixX cross = MatrixX::Zero(rows.rows(), covariance_.cols()), inner = MatrixX::Identity(rows.rows(), rows.rows());
  add_product(cross, rows, covariance_);
  add_product(inner, cross, rows.transpose());
  cholesky(inner);
  MatrixX whitened = residual;
  solve_lower(inner, cross);
  solve_lower(inner, whitened);
  VectorX change = VectorX::Zero(covariance_.cols());
  add_transposed_product(change, cross, whitened);
  add_transposed_product(covariance_, cross, cross, -1);
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  return change;
}

VERNIER_IMPL VectorX initial_std(const FrameUpdate& update, const ReregisterOptions& options,
                                 const std::array<double, 2>& sizes) {
  options.validate();
  require(sizes[0] > 0 && sizes[1] > 0, "RecursiveCalibration: initial standard deviations must be positive");
  VectorX out(update.size());
  for (Index k = 0; k < out.size(); ++k) out(k) = k % 6 < 3 ? sizes[0] : sizes[1];
  if (update.tool)
    for (Index k = 0; k < 6; ++k) out(out.size() - 6 + k) = k < 3 ? sizes[0] : sizes[1];
  if (update.offsets) out.segment(update.offsets_begin(), update.joints).setConstant(options.offset_prior_std);
  return out;
}

VERNIER_IMPL void whitened_rows(const FrameUpdate& update, const SensorModel& sensors, const Isometry3& modelled,
                                const double* jacobian, const Isometry3& measured, bool oriented, MatrixX& rows,
                                VectorX& residual) {
  Vector6 difference = pose_difference(measured, modelled);
  difference.head<3>() /= sensors.position_sigma;
  difference.tail<3>() /= sensors.orientation_sigma;
  const Rows6 columns = update.columns(modelled, jacobian);
  const Index used = oriented ? 6 : 3;
  residual = difference.head(used);
  rows = columns.topRows(used);
  rows.topRows(3) /= sensors.position_sigma;
  if (oriented) rows.bottomRows(3) /= sensors.orientation_sigma;
}

}  // namespace vernier::detail
