#pragma once

#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

VERNIER_IMPL JointFunction ErrorModelEstimate::transmission(int joint, const std::vector<double>& angles) const {
  require(!angles.empty(), "transmission: no angles");
  const JointTerms& terms = arm.terms();
  const Index n = static_cast<Index>(angles.size());
  const Index count = terms.transmission[static_cast<std::size_t>(joint)].size();
  if (count == 0) return {VectorX::Zero(n), VectorX::Zero(n)};
  const Index first = terms.transmission_begin(joint) - terms.num_dense_terms(), at = arm.num_dense() + first;
  MatrixX rows(n, count);
  VectorX all;
  for (Index k = 0; k < n; ++k) {
    const VectorX q = VectorX::Constant(terms.joints, angles[static_cast<std::size_t>(k)]);
    arm.transmission_values(q.data(), all);
    rows.row(k) = all.segment(first, count).transpose();
  }
  rows.rowwise() -= rows.colwise().mean().eval();
  MatrixX spread = MatrixX::Zero(n, count), value = MatrixX::Zero(n, 1);
  detail::add_product(spread, rows, covariance.block(at, at, count, count));
  detail::add_product(value, rows, arm.steps().segment(at, count));
  return {value, spread.cwiseProduct(rows).rowwise().sum().cwiseMax(0).cwiseSqrt()};
}

namespace detail {

/// Covariance of the modelled pose; `rows` is the linearised pose.
VERNIER_API Matrix6 pose_covariance(const ErrorModelEstimate& estimate, const ConstVectorRef& q, int station,
                                    const ConstVectorRef& previous, double warmer, RowBlock& rows) {
  const MatrixX joints = q.transpose(), before = previous.size() > 0 ? MatrixX(previous.transpose()) : MatrixX();
  estimate.arm.linearise(station, joints, before, &rows, true, VectorX::Constant(1, warmer));
  const Index unknowns = estimate.arm.size();
  Rows6 all(6, unknowns);
  rows.expand(estimate.arm.group_sizes(), all);
  MatrixX half = MatrixX::Zero(6, unknowns), sum = MatrixX::Zero(6, 6);
  add_product(half, all, estimate.covariance);
  add_product(sum, half, all.transpose());
  return sum;
}

}  // namespace detail

VERNIER_IMPL Matrix6 ErrorModelEstimate::model_covariance(const ConstVectorRef& q, int station) const {
  RowBlock rows;
  return detail::pose_covariance(*this, q, station, VectorX(), 0, rows);
}

VERNIER_IMPL Matrix6 ErrorModelEstimate::visit_covariance(const ConstVectorRef& q, double gate, int station,
                                                          const ConstVectorRef& previous, double temperature) const {
  RowBlock rows;
  const bool known = std::isfinite(temperature);
  Matrix6 out = detail::pose_covariance(*this, q, station, previous, known ? temperature - mean_temperature : 0, rows);
  if (!known && temperature_std > 0) {  // what a standard deviation of temperature does
    RowBlock warm;
    detail::pose_covariance(*this, q, station, previous, temperature_std, warm);
    Vector6 effect = Vector6::Zero();
    const VectorX steps = arm.steps();
    for (std::size_t k = 0; k < arm.geometric().size(); ++k)
      if (arm.geometric()[k].thermal) effect += steps(static_cast<Index>(k)) * warm.dense.col(static_cast<Index>(k));
    out += effect * effect.transpose();
  }
  if (!arm.terms().hysteresis.empty() && (previous.size() == 0 || !previous.allFinite()))
    for (int j = 0; j < arm.terms().joints; ++j) {
      const Vector6 half = rows.factor.col(j) * arm.joint_errors().half_loop(j);
      out += half * half.transpose();
    }
  out += joint_sigma * joint_sigma * rows.factor.lazyProduct(rows.factor.transpose());
  if (gate < 1)  // errors that the suppressed terms would have corrected
    out.diagonal().head<3>().array() +=
        std::pow((1 - gate) * fallback_error / 1.6, 2);  // a mean norm is 1.6 sigma of a component
  out.diagonal().head<3>().array() += position_sigma * position_sigma;
  out.diagonal().tail<3>().array() += orientation_sigma * orientation_sigma;
  return out;
}

}  // namespace vernier
