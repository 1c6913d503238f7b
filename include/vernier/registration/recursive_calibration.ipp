// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/registration/recursive_calibration.hpp"

namespace vernier::detail {

VERNIER_IMPL RecursiveEstimator::RecursiveEstimator(const VectorX& std, double forgetting)
    : start_(VERNIER_LATER(std).cwiseProduct(std)),
      covariance_(MatrixX::Zero(std.size(), std.size())),
      forgetting_(forgetting) {
  demand(forgetting > 0 && forgetting <= 1, "RecursiveCalibration: forgetting is ", forgetting, ", must lie in (0, 1]");
  for (Index k = 0; k < std.size(); ++k) covariance_(k, k) = start_(k);
}

VERNIER_IMPL VectorX RecursiveEstimator::update(const MatrixX& rows, const VectorX& residual) {
  demand(all_finite(residual), "RecursiveCalibration: a measured value is not finite");
  if (forgetting_ < 1) {  // towards the initial covariance: what is not excited does not grow without bound
    cholesky(covariance_);
    MatrixX information = forgetting_ * inverse_from_cholesky(covariance_);
    for (Index k = 0; k < start_.size(); ++k) information(k, k) += (1 - forgetting_) / start_(k);
    cholesky(information);
    covariance_ = inverse_from_cholesky(information);
  }
  MatrixX cross = MatrixX::Zero(rows.rows(), covariance_.cols()), inner = MatrixX::Identity(rows.rows(), rows.rows());
  add_product(cross, rows, covariance_);
  add_product(inner, cross, VERNIER_LATER(rows).transpose());
  cholesky(inner);
  MatrixX whitened = residual;
  solve_lower(inner, cross);
  solve_lower(inner, whitened);
  VectorX change = VectorX::Zero(covariance_.cols());
  add_transposed_product(change, cross, whitened);
  add_transposed_product(covariance_, cross, cross, -1);
  for (Index c = 0; c < covariance_.cols(); ++c)
    for (Index r = 0; r < c; ++r) covariance_(r, c) = covariance_(c, r) = 0.5 * (covariance_(r, c) + covariance_(c, r));
  return change;
}

VERNIER_IMPL VectorX initial_std(const FrameUpdate& update, const ReregisterOptions& options,
                                 const std::array<double, 2>& sizes) {
  options.validate();
  demand(sizes[0] > 0 && sizes[1] > 0, "RecursiveCalibration: initial standard deviations must be positive");
  VectorX out(update.size());
  for (Index k = 0; k < out.size(); ++k) out(k) = k < 3 ? sizes[0] : sizes[1];
  if (update.tool)
    for (Index k = 0; k < 6; ++k) out(out.size() - 6 + k) = k < 3 ? sizes[0] : sizes[1];
  if (update.offsets)
    VERNIER_LATER(out).segment(update.offsets_begin(), update.joints).setConstant(options.offset_prior_std);
  return out;
}

VERNIER_IMPL void whitened_rows(const FrameUpdate& update, const SensorModel& sensors, const Isometry3& modelled,
                                const double* jacobian, const Isometry3& measured, bool oriented, MatrixX& rows,
                                VectorX& residual) {
  const Vector6 difference = pose_difference(measured, modelled);
  const Rows6 columns = update.columns(modelled, jacobian);
  rows.resize(oriented ? 6 : 3, columns.cols());
  residual.resize(rows.rows());
  for (Index r = 0; r < rows.rows(); ++r) {
    const double sigma = r < 3 ? sensors.position_sigma : sensors.orientation_sigma;
    residual(r) = difference(r) / sigma;
    for (Index c = 0; c < rows.cols(); ++c) rows(r, c) = columns(r, c) / sigma;
  }
}

}  // namespace vernier::detail
