#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/error_model_estimate.hpp"

namespace vernier {

namespace detail {

VERNIER_IMPL ArmParameterisation parameterised(const FittedArm& arm, std::vector<GeometricUnknown> unknowns,
                                               const VectorX& coefficient_scales, const VectorX& coefficient_precisions,
                                               const VectorX& thermal_rates) {
  ArmParameterisation out({arm.geometry}, std::move(unknowns));
  out.set_terms(arm.errors.terms(), coefficient_scales, coefficient_precisions);
  VectorX steps = VectorX::Zero(out.size());
  for (std::size_t k = 0; k < out.geometric().size(); ++k)
    if (const GeometricUnknown& u = out.geometric()[k]; u.thermal && thermal_rates.size() > 0)
      steps(static_cast<Index>(k)) = thermal_rates(u.parameter) / u.scale;
  if (!arm.errors.empty())
    steps.tail(arm.errors.coefficients().size()) = arm.errors.coefficients().cwiseQuotient(coefficient_scales);
  out.move(steps);
  return out;
}

}  // namespace detail

VERNIER_IMPL ErrorModelEstimate ErrorModelEstimate::first_station() const {
  std::vector<GeometricUnknown> unknowns;
  std::vector<Index> kept;
  for (std::size_t k = 0; k < arm.geometric().size(); ++k) {
    GeometricUnknown u = arm.geometric()[k];
    if (u.station > 0) continue;
    u.station = -1;
    unknowns.push_back(u);
    kept.push_back(static_cast<Index>(k));
  }
  const Index terms = arm.terms().size();
  for (Index k = 0; k < terms; ++k) kept.push_back(static_cast<Index>(arm.geometric().size()) + k);
  ErrorModelEstimate out{.arm = detail::parameterised({arm.geometry(0), arm.joint_errors()}, std::move(unknowns),
                                                      arm.scales().tail(terms), arm.precisions().tail(terms),
                                                      arm.thermal_rates(0))};
  out.converged = converged;
  out.position_sigma = position_sigma;
  out.joint_sigma = joint_sigma;
  out.orientation_sigma = orientation_sigma;
  out.fallback_error = fallback_error;
  out.mean_temperature = mean_temperature;
  out.temperature_std = temperature_std;
  out.covariance = covariance(kept, kept);
  out.variance_factor = variance_factor;
  out.residual_variance = residual_variance;
  return out;
}

VERNIER_IMPL ErrorModelEstimate ErrorModelEstimate::of_arm(const FittedArm& now) const {
  ErrorModelEstimate out = *this;
  const Index terms = arm.terms().size();
  require(now.errors.terms().size() == terms, "of_arm: ", now.errors.terms().size(),
          " terms of joint errors, expected ", terms);
  out.arm = detail::parameterised(now, arm.geometric(), arm.scales().tail(terms), arm.precisions().tail(terms),
                                  arm.thermal_rates(0));
  return out;
}

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

/// Covariances of modelled poses at n configurations; `rows` are the linearised poses.
VERNIER_API std::vector<Matrix6> pose_covariances(const ErrorModelEstimate& estimate, const ConstMatrixRef& joints,
                                                  int station, const ConstMatrixRef& previous, const VectorX& warmer,
                                                  std::vector<RowBlock>& rows) {
  const Index n = joints.rows(), unknowns = estimate.arm.size();
  rows.resize(static_cast<std::size_t>(n));
  estimate.arm.linearise(station, joints, previous, rows.data(), true, warmer);
  MatrixX all(unknowns, 6 * n), half = MatrixX::Zero(unknowns, 6 * n);  // the rows of each pose are contiguous columns
  Rows6 one(6, unknowns);
  for (Index i = 0; i < n; ++i) {
    rows[static_cast<std::size_t>(i)].expand(estimate.arm.group_sizes(), one);
    all.middleCols(6 * i, 6) = one.transpose();
  }
  add_product(half, estimate.covariance, all);
  std::vector<Matrix6> out;
  for (Index i = 0; i < n; ++i)
    out.push_back(half.middleCols(6 * i, 6).transpose().lazyProduct(all.middleCols(6 * i, 6)));
  return out;
}

}  // namespace detail

VERNIER_IMPL Matrix6 ErrorModelEstimate::model_covariance(const ConstVectorRef& q, int station) const {
  std::vector<RowBlock> rows;
  return detail::pose_covariances(*this, q.transpose(), station, MatrixX(), VectorX::Zero(1), rows).front();
}

VERNIER_IMPL Matrix6 ErrorModelEstimate::visit_covariance(const ConstVectorRef& q, double gate, int station,
                                                          const ConstVectorRef& previous, double temperature) const {
  const MatrixX before = previous.size() > 0 ? MatrixX(previous.transpose()) : MatrixX();
  return visit_covariances(q.transpose(), VectorX::Constant(1, gate), station, before,
                           VectorX::Constant(1, temperature))
      .front();
}

VERNIER_IMPL std::vector<Matrix6> ErrorModelEstimate::visit_covariances(const ConstMatrixRef& joints,
                                                                        const ConstVectorRef& gates, int station,
                                                                        const ConstMatrixRef& previous,
                                                                        const ConstVectorRef& temperatures) const {
  constexpr Index batch = 64;
  std::vector<Matrix6> all;
  const VectorX steps = arm.steps();
  for (Index first = 0; first < joints.rows(); first += batch) {
    const Index n = std::min(batch, joints.rows() - first);
    const MatrixX q = joints.middleRows(first, n),
                  before = previous.rows() > 0 ? MatrixX(previous.middleRows(first, n)) : MatrixX();
    VectorX warmer = VectorX::Zero(n);
    std::vector<bool> known(static_cast<std::size_t>(n), false);
    for (Index i = 0; i < n && temperatures.size() > 0; ++i)
      if (std::isfinite(temperatures(first + i))) {
        known[static_cast<std::size_t>(i)] = true;
        warmer(i) = temperatures(first + i) - mean_temperature;
      }
    std::vector<RowBlock> rows, warm;
    const std::vector<Matrix6> modelled = detail::pose_covariances(*this, q, station, before, warmer, rows);
    if (temperature_std > 0) {
      warm.resize(static_cast<std::size_t>(n));
      arm.linearise(station, q, before, warm.data(), true, VectorX::Constant(n, temperature_std));
    }
    for (std::size_t i = 0; i < modelled.size(); ++i) {
      const auto row = static_cast<Index>(i);
      Matrix6 out = modelled[i];
      if (!known[i] && temperature_std > 0) {  // what a standard deviation of temperature does
        Vector6 effect = Vector6::Zero();
        for (Index k = 0; k < static_cast<Index>(arm.geometric().size()); ++k)
          if (arm.geometric()[static_cast<std::size_t>(k)].thermal) effect += steps(k) * warm[i].dense.col(k);
        out += effect * effect.transpose();
      }
      if (!arm.terms().hysteresis.empty() && (before.rows() == 0 || !before.row(row).allFinite()))
        for (int j = 0; j < arm.terms().joints; ++j) {
          const Vector6 half = rows[i].factor.col(j) * arm.joint_errors().half_loop(j);
          out += half * half.transpose();
        }
      out += joint_sigma * joint_sigma * rows[i].factor.lazyProduct(rows[i].factor.transpose());
      const double gate = gates(first + row);
      if (gate < 1)  // errors that the suppressed terms would have corrected
        out.diagonal().head<3>().array() +=
            std::pow((1 - gate) * fallback_error / 1.6, 2);  // a mean norm is 1.6 sigma of a component
      out.diagonal().head<3>().array() += position_sigma * position_sigma;
      out.diagonal().tail<3>().array() += orientation_sigma * orientation_sigma;
      all.push_back(out);
    }
  }
  return all;
}

}  // namespace vernier
