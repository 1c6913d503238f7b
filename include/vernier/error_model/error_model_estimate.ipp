// SPDX-License-Identifier: BSD-3-Clause
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
  if (!arm.errors.empty()) {
    const VectorX& coefficients = arm.errors.coefficients();
    for (Index k = 0, first = steps.size() - coefficients.size(); k < coefficients.size(); ++k)
      steps(first + k) = coefficients(k) / coefficient_scales(k);
  }
  out.move(steps);
  return out;
}

}  // namespace detail

VERNIER_IMPL ErrorModelEstimate ErrorModelEstimate::of_station(int station) const {
  std::vector<GeometricUnknown> unknowns;
  std::vector<Index> kept;
  for (std::size_t k = 0; k < arm.geometric().size(); ++k) {
    GeometricUnknown u = arm.geometric()[k];
    if (!u.acts_on(station)) continue;
    u.station = -1;
    u.shared_with.clear();
    unknowns.push_back(u);
    kept.push_back(static_cast<Index>(k));
  }
  const Index terms = arm.terms().size();
  for (Index k = 0; k < terms; ++k) kept.push_back(static_cast<Index>(arm.geometric().size()) + k);
  ErrorModelEstimate out{.arm = detail::parameterised({arm.geometry(station), arm.joint_errors()}, std::move(unknowns),
                                                      VERNIER_LATER(arm).scales().tail(terms),
                                                      VERNIER_LATER(arm).precisions().tail(terms),
                                                      arm.thermal_rates(station))};
  out.converged = converged;
  out.position_sigma = position_sigma;
  out.joint_sigma = joint_sigma;
  out.orientation_sigma = orientation_sigma;
  out.fallback_error = fallback_error;
  out.mean_temperature = mean_temperature;
  out.temperature_std = temperature_std;
  out.covariance = detail::rows_of(MatrixX(VERNIER_LATER(detail::rows_of(covariance, kept)).transpose()), kept);
  out.variance_factor = variance_factor;
  out.residual_variance = residual_variance;
  return out;
}

VERNIER_IMPL ErrorModelEstimate ErrorModelEstimate::of_arm(const FittedArm& now) const {
  ErrorModelEstimate out = *this;
  const Index terms = arm.terms().size();
  demand(now.errors.terms().size() == terms, "of_arm: ", now.errors.terms().size(), " terms of joint errors, expected ",
         terms);
  out.arm = detail::parameterised(now, arm.geometric(), VERNIER_LATER(arm.scales()).tail(terms),
                                  VERNIER_LATER(arm.precisions()).tail(terms), arm.thermal_rates(0));
  return out;
}

VERNIER_IMPL JointFunction ErrorModelEstimate::transmission(int joint, const std::vector<double>& angles) const {
  demand(!angles.empty(), "transmission: no angles");
  const JointTerms& terms = arm.terms();
  const Index n = static_cast<Index>(angles.size());
  const Index count = terms.transmission[static_cast<std::size_t>(joint)].size();
  if (count == 0) return {VectorX::Zero(n), VectorX::Zero(n)};
  const Index first = terms.transmission_begin(joint) - terms.num_dense_terms(), at = arm.num_dense() + first;
  MatrixX rows(n, count);
  VectorX all;
  for (Index k = 0; k < n; ++k) {
    const VectorX q = VectorX::Constant(terms.joints, angles[static_cast<std::size_t>(k)]);
    arm.function_values(q.data(), all);
    for (Index c = 0; c < count; ++c) rows(k, c) = all(first + c);
  }
  rows = detail::rows_minus(rows, detail::column_means(rows));
  const MatrixX spread = detail::matrix_product(rows, VERNIER_LATER(covariance).block(at, at, count, count));
  JointFunction out{detail::product(rows, VERNIER_LATER(arm.steps()).segment(at, count)), VectorX(n)};
  for (Index k = 0; k < n; ++k) {
    double variance = 0;
    for (Index c = 0; c < count; ++c) variance += spread(k, c) * rows(k, c);
    out.std(k) = std::sqrt((std::max)(variance, 0.0));
  }
  return out;
}

namespace detail {

/// Rows first .. first + count - 1.
VERNIER_LOCAL inline MatrixX consecutive_rows(const ConstMatrixRef& rows, Index first, Index count) {
  MatrixX out(count, rows.cols());
  for (Index c = 0; c < rows.cols(); ++c)
    for (Index r = 0; r < count; ++r) out(r, c) = rows(first + r, c);
  return out;
}

/// A vector as the only row.
VERNIER_LOCAL inline MatrixX one_row(const ConstVectorRef& values) {
  MatrixX out(1, values.size());
  for (Index k = 0; k < values.size(); ++k) out(0, k) = values(k);
  return out;
}

/// Covariances of modelled poses by the unknowns, at n configurations.
/// @param rows the linearised poses
VERNIER_LOCAL std::vector<Matrix6> pose_covariances(const ErrorModelEstimate& estimate,
                                                    const std::vector<RowBlock>& rows) {
  const Index n = static_cast<Index>(rows.size()), unknowns = estimate.arm.size();
  MatrixX all(unknowns, 6 * n);  // the rows of each pose are contiguous columns
  Rows6 one(6, unknowns);
  for (Index i = 0; i < n; ++i) {
    rows[static_cast<std::size_t>(i)].expand(estimate.arm.group_sizes(), one);
    for (Index r = 0; r < 6; ++r)
      for (Index k = 0; k < unknowns; ++k) all(k, 6 * i + r) = one(r, k);
  }
  const MatrixX half = matrix_product(estimate.covariance, all);
  std::vector<Matrix6> out(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    for (Index c = 0; c < 6; ++c)
      for (Index r = 0; r < 6; ++r)
        out[static_cast<std::size_t>(i)](r, c) =
            VERNIER_LATER(half).col(6 * i + r).dot(VERNIER_LATER(all).col(6 * i + c));
  return out;
}

/// out += factor x x'
VERNIER_LOCAL inline void add_outer_product(const Vector6& x, double factor, Matrix6& out) {
  for (Index c = 0; c < 6; ++c)
    for (Index r = 0; r < 6; ++r) out(r, c) += factor * x(r) * x(c);
}

}  // namespace detail

VERNIER_IMPL Matrix6 ErrorModelEstimate::model_covariance(const ConstVectorRef& q, int station) const {
  std::vector<RowBlock> rows(1);
  arm.linearise(station, detail::one_row(q), MatrixX(), rows.data(), true, VectorX::Zero(1), MatrixX());
  return detail::pose_covariances(*this, rows).front();
}

VERNIER_IMPL Matrix6 ErrorModelEstimate::visit_covariance(const ConstVectorRef& q, double gate, int station,
                                                          const ConstVectorRef& previous, double temperature) const {
  const MatrixX before = previous.size() > 0 ? detail::one_row(previous) : MatrixX();
  return visit_covariances(detail::one_row(q), VectorX::Constant(1, gate), station, before,
                           VectorX::Constant(1, temperature))
      .front();
}

VERNIER_IMPL std::vector<Matrix6> ErrorModelEstimate::visit_covariances(
    const ConstMatrixRef& joints, const ConstVectorRef& gates, int station, const ConstMatrixRef& previous,
    const ConstVectorRef& temperatures, const ConstMatrixRef& payloads, bool of_unknowns) const {
  constexpr Index batch = 64;
  std::vector<Matrix6> all;
  const VectorX steps = arm.steps();
  for (Index first = 0; first < joints.rows(); first += batch) {
    const Index n = (std::min)(batch, joints.rows() - first);
    const MatrixX q = detail::consecutive_rows(joints, first, n),
                  before = previous.rows() > 0 ? detail::consecutive_rows(previous, first, n) : MatrixX(),
                  carried = payloads.rows() > 0 ? detail::consecutive_rows(payloads, first, n) : MatrixX();
    VectorX warmer = VectorX::Zero(n);
    std::vector<bool> known(static_cast<std::size_t>(n), false);
    for (Index i = 0; i < n && temperatures.size() > 0; ++i)
      if (std::isfinite(temperatures(first + i))) {
        known[static_cast<std::size_t>(i)] = true;
        warmer(i) = temperatures(first + i) - mean_temperature;
      }
    std::vector<RowBlock> rows(static_cast<std::size_t>(n)), warm;
    arm.linearise(station, q, before, rows.data(), true, warmer, carried);
    const std::vector<Matrix6> modelled =
        of_unknowns ? detail::pose_covariances(*this, rows) : std::vector<Matrix6>(rows.size(), Matrix6::Zero());
    if (temperature_std > 0) {
      warm.resize(static_cast<std::size_t>(n));
      arm.linearise(station, q, before, warm.data(), true, VectorX::Constant(n, temperature_std), carried);
    }
    for (std::size_t i = 0; i < modelled.size(); ++i) {
      const auto row = static_cast<Index>(i);
      Matrix6 out = modelled[i];
      if (!known[i] && temperature_std > 0) {  // what a standard deviation of temperature does
        Vector6 effect = Vector6::Zero();
        for (Index k = 0; k < static_cast<Index>(arm.geometric().size()); ++k)
          if (arm.geometric()[static_cast<std::size_t>(k)].thermal)
            effect += steps(k) * detail::column_of(warm[i].dense, k);
        detail::add_outer_product(effect, 1, out);
      }
      const bool by_half_loops = !arm.terms().hysteresis.empty() &&
                                 (before.rows() == 0 || !detail::all_finite(VERNIER_LATER(before).middleRows(row, 1)));
      for (int j = 0; j < static_cast<int>(rows[i].factor.cols()); ++j) {
        const double half_loop = by_half_loops ? arm.joint_errors().half_loop(j) : 0;
        detail::add_outer_product(detail::column_of(rows[i].factor, j),
                                  joint_sigma * joint_sigma + half_loop * half_loop, out);
      }
      const double gate = gates(first + row);
      // errors that the suppressed terms would have corrected; a mean norm is 1.6 sigma of a component
      const double suppressed = gate < 1 ? (1 - gate) * fallback_error / 1.6 : 0;
      for (Index r = 0; r < 3; ++r) {
        out(r, r) += suppressed * suppressed + position_sigma * position_sigma;
        out(r + 3, r + 3) += orientation_sigma * orientation_sigma;
      }
      all.push_back(out);
    }
  }
  return all;
}

}  // namespace vernier
