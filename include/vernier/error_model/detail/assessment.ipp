// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/assessment.hpp"
#include "vernier/error_model/detail/visit_noise.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"

namespace vernier::detail {

/// Columns of a block's rows as changes of its position [m].
VERNIER_LOCAL Vector3 position_change(const RowBlock& rows, const Rows6& columns, Index k) {
  Vector3 out = Vector3::Zero();
  for (Index s = 0; s < 6; ++s)
    for (Index r = 0; r < 3; ++r) out(r) += rows.unwhiten(r, s) * columns(s, k);
  return rows.position_sigma * out;
}

/// Collects poses left out, and the covariances that the unknowns give their positions: many at once.
class LeftOutVisits {
 public:
  VERNIER_LOCAL explicit LeftOutVisits(const MatrixX& covariance)
      : covariance_(covariance), rows_(covariance.rows(), 3 * batch) {}

  /// @param columns of all unknowns, as in `rows`
  VERNIER_LOCAL void add(const Vector3& error, const Matrix3& joint_noise, const RowBlock& rows, const Rows6& columns) {
    for (Index k = 0; k < covariance_.rows(); ++k) {
      const Vector3 change = position_change(rows, columns, k);
      for (Index r = 0; r < 3; ++r) rows_(k, 3 * waiting_ + r) = change(r);
    }
    visits_.push_back({error, Matrix3::Zero(), joint_noise});
    if (++waiting_ == batch) multiply();
  }

  VERNIER_LOCAL const std::vector<LeftOutVisit>& all() {
    multiply();
    return visits_;
  }

 private:
  VERNIER_LOCAL void multiply() {
    const MatrixX half = matrix_product(covariance_, VERNIER_LATER(rows_).leftCols(3 * waiting_));
    for (Index i = 0; i < waiting_; ++i) {
      Matrix3& model = visits_[visits_.size() - static_cast<std::size_t>(waiting_ - i)].model;
      for (Index c = 0; c < 3; ++c)
        for (Index r = 0; r < 3; ++r)
          model(r, c) = VERNIER_LATER(rows_).col(3 * i + r).dot(VERNIER_LATER(half).col(3 * i + c));
    }
    waiting_ = 0;
  }

  static constexpr Index batch = 64;
  const MatrixX& covariance_;
  MatrixX rows_;  // those of each pose are contiguous columns
  Index waiting_ = 0;
  std::vector<LeftOutVisit> visits_;
};

VERNIER_IMPL void assess(const ModelSelection& model, ErrorModelEstimate& estimate) {
  const CalibrationProblem& problem = model.problem;
  const ModelSelection::Linearised& at = model.linearised();
  const auto& system = at.system;  // lambdas of clang 14 cannot capture bindings
  const VectorX precisions = problem.arm.precisions();
  const FactorisedEquations solved(at.normal, precisions, at.steps, at.local_steps);
  const Index p = system.unknowns();
  estimate.covariance = VERNIER_LATER(solved).inverse();
  double explained = static_cast<double>(p) - diagonal_of(estimate.covariance).dot(precisions);
  for (Index k = 0; k < at.normal.prior.cols(); ++k)
    explained -= VERNIER_LATER(estimate.covariance).col(k).dot(VERNIER_LATER(at.normal.prior).col(k));
  const double values = static_cast<double>(problem.measured_values());
  const double freedom = (std::max)(1.0, values - explained);
  estimate.residual_variance = estimate.variance_factor = at.normal.cost / freedom;
  estimate.covariance *= estimate.variance_factor;

  // leave-one-pose-out errors contain the noise of a visit and the uncertainty of the unknowns
  const Eigen::Matrix3Xd errors = model.left_out_errors(solved);
  estimate.leave_one_out_seconds = model.leave_one_out_seconds;
  LeftOutVisits collected(estimate.covariance);
  Rows6 all(6, p);
  double rotation_sum = 0, rotation_values = 0, distance_sum = 0;
  visit_blocks(system, 0, 1, system.blocks, [&](Index b, const RowBlock& rows) {
    const MeasuredSet& set = problem.set_of(b);
    if (set.oriented()) {
      const Vector6 residual = rows.unwhiten * rows.residual;
      const Vector3 rotation(residual(3), residual(4), residual(5));
      rotation_sum += rotation.squaredNorm() * set.sigma().angle * set.sigma().angle;
      rotation_values += 3;
    }
    if (b % model.stride != 0 || b >= system.validation_blocks) return;
    Vector3 error(errors(0, b / model.stride), errors(1, b / model.stride), errors(2, b / model.stride));
    if (set.positions() == nullptr) {
      distance_sum += error.squaredNorm();
      return;
    }
    // what is deployed does not know the drift
    const Vector3 measured = set.position(problem.row_of(b));
    error += measured - transformed(problem.drift_motion(b), measured);
    const VectorX zeros = problem.drift_joint_zeros(b);
    Matrix3 joint_noise = Matrix3::Zero();
    for (Index j = 0; j < rows.factor.cols(); ++j) {
      const Vector3 joint = position_change(rows, rows.factor, j);
      if (zeros.size() > 0) error -= zeros(j) * joint;
      for (Index c = 0; c < 3; ++c)
        for (Index r = 0; r < 3; ++r) joint_noise(r, c) += joint(r) * joint(c);
    }
    rows.expand(system.group_sizes, all);
    estimate.left_out_rows.push_back(b);
    collected.add(error, joint_noise, rows, all);
  });
  if (rotation_values > 0) estimate.orientation_sigma = std::sqrt(rotation_sum / rotation_values * values / freedom);
  const std::vector<LeftOutVisit>& visits = collected.all();
  estimate.left_out_errors.resize(static_cast<Index>(visits.size()));
  for (std::size_t k = 0; k < visits.size(); ++k)
    estimate.left_out_errors(static_cast<Index>(k)) = visits[k].error.norm();
  if (visits.empty()) {
    estimate.position_sigma = std::sqrt(distance_sum / static_cast<double>(errors.cols()));
    return;
  }
  const VisitNoise noise = visit_noise(visits);
  estimate.position_sigma = noise.position;
  estimate.joint_sigma = noise.joint;
  estimate.covariance *= noise.model;
  estimate.variance_factor *= noise.model;
}

}  // namespace vernier::detail
