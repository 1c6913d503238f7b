// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/error_model/detail/prior_transfer.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"

namespace vernier::detail {

VERNIER_IMPL MatrixX TransferredUnknowns::widened(double geometry, double joints) const {
  MatrixX out = covariance;
  for (Index k = 0; k < expected.size(); ++k) {
    const double change = k < geometric ? geometry : joints;
    out(k, k) += change * change * expected(k);
  }
  return out;
}

VERNIER_IMPL JointPrior TransferredUnknowns::prior(Index size, double geometry, double joints) const {
  const auto n = static_cast<Index>(unknowns.size());
  JointPrior out{MatrixX::Zero(size, size), VectorX::Zero(size), n};
  MatrixX factor = widened(geometry, joints);
  demand(cholesky(factor), "an earlier calibration: its covariance is not positive definite");
  const MatrixX precision = inverse_from_cholesky(factor);
  for (Index j = 0; j < n; ++j) {
    const Index column = unknowns[static_cast<std::size_t>(j)];
    out.mean(column) = mean(j);
    for (Index i = 0; i < n; ++i) out.precision(unknowns[static_cast<std::size_t>(i)], column) = precision(i, j);
  }
  return out;
}

/// Whether an unknown is of the chain, and not of a frame.
VERNIER_LOCAL bool of_chain(const GeometricUnknown& unknown, int joints) {
  return unknown.parameter >= ArmParameters::chain_begin && unknown.parameter < ArmParameters::chain_end(joints);
}

VERNIER_IMPL std::vector<GeometricUnknown> with_unknowns_of(const ArmPrior& prior,
                                                            std::vector<GeometricUnknown> unknowns) {
  for (GeometricUnknown known : prior.estimate.arm.geometric()) {
    if (!of_chain(known, prior.nominal.joints())) continue;
    known.precision = 0;
    const auto same = std::find_if(unknowns.begin(), unknowns.end(), [&](const GeometricUnknown& u) {
      return u.parameter == known.parameter && u.thermal == known.thermal;
    });
    if (same == unknowns.end())
      unknowns.push_back(known);
    else
      same->precision = 0;
  }
  return unknowns;
}

VERNIER_IMPL TransferredUnknowns transferred_unknowns(const ArmPrior& prior, const ArmParameterisation& arm,
                                                      const ChainTable& nominal) {
  const ErrorModelEstimate& before = prior.estimate;
  const std::vector<GeometricUnknown>&earlier = before.arm.geometric(), &now = arm.geometric();
  const double noise = before.variance_factor;
  TransferredUnknowns out;
  UnknownGroup source;
  std::vector<double> units, means, expected;
  const VectorX designed = ArmGeometry(nominal, {}, {}).parameters(), was = before.arm.geometry(0).parameters();
  const VectorX was_designed = ArmGeometry(prior.nominal, {}, {}).parameters(), start = arm.geometry(0).parameters();
  const VectorX steps = before.arm.steps();
  for (std::size_t k = 0; k < earlier.size(); ++k) {
    const GeometricUnknown& known = earlier[k];
    if (!of_chain(known, nominal.joints())) continue;
    for (std::size_t u = 0; u < now.size(); ++u) {
      if (now[u].parameter != known.parameter || now[u].thermal != known.thermal) continue;
      out.unknowns.push_back(static_cast<Index>(u));
      source.push_back(static_cast<Index>(k));
      const double unit = known.scale / now[u].scale;
      units.push_back(unit);
      if (known.thermal) {
        means.push_back(steps(static_cast<Index>(k)) * unit);
        expected.push_back(unit * unit / (std::max)(known.precision, 1e-6));
      } else {
        const Index p = known.parameter;
        means.push_back((designed(p) + was(p) - was_designed(p) - start(p)) / now[u].scale);
        expected.push_back(1 / noise);
      }
    }
  }
  out.geometric = static_cast<Index>(out.unknowns.size());
  const VectorX precisions = before.arm.precisions();
  for (Index k = 0; k < before.arm.terms().size(); ++k) {
    const Index from = static_cast<Index>(earlier.size()) + k;
    out.unknowns.push_back(static_cast<Index>(now.size()) + k);
    source.push_back(from);
    units.push_back(1);
    means.push_back(steps(from));
    expected.push_back(1 / (std::max)(precisions(from), 1e-6));
  }
  const auto n = static_cast<Index>(source.size());
  out.mean = Eigen::Map<const VectorX>(means.data(), n);
  out.expected = Eigen::Map<const VectorX>(expected.data(), n);
  out.covariance.resize(n, n);
  for (std::size_t j = 0; j < source.size(); ++j)
    for (std::size_t i = 0; i < source.size(); ++i)
      out.covariance(static_cast<Index>(i), static_cast<Index>(j)) =
          before.covariance(source[i], source[j]) * units[i] * units[j] / noise;
  return out;
}

VERNIER_IMPL PriorTransfer likely_transfer(const CalibrationProblem& problem, const TransferredUnknowns& known) {
  constexpr Index enough = 100;
  const BlockSystem system = problem.system();
  const Index stride = std::max<Index>(1, system.blocks / enough), count = (system.blocks + stride - 1) / stride;
  const auto n = static_cast<Index>(known.unknowns.size());
  const VectorX steps = problem.arm.steps();
  VectorX offset(n);
  for (Index k = 0; k < n; ++k) offset(k) = known.mean(k) - steps(known.unknowns[static_cast<std::size_t>(k)]);
  // residuals at the mean of the prior, and their covariance in three parts
  MatrixX rows(6 * count, n), others(6 * count, system.unknowns() - n);
  VectorX error(6 * count);
  Rows6 all(6, system.unknowns());
  Index values = 0;
  std::vector<bool> transferred(static_cast<std::size_t>(system.unknowns()), false);
  for (const Index k : known.unknowns) transferred[static_cast<std::size_t>(k)] = true;
  visit_blocks(system, 0, stride, count, [&](Index b, const RowBlock& block) {
    block.expand(system.group_sizes, all);
    for (Index r = 0; r < 6; ++r) {
      for (Index k = 0; k < n; ++k) rows(6 * b + r, k) = all(r, known.unknowns[static_cast<std::size_t>(k)]);
      for (Index k = 0, at = 0; k < system.unknowns(); ++k)
        if (!transferred[static_cast<std::size_t>(k)]) others(6 * b + r, at++) = all(r, k);
      error(6 * b + r) = block.residual(r);
    }
    values += problem.set_of(b * stride).values();
  });
  add_product(error, rows, offset);
  const auto covariance_of = [](const MatrixX& columns, const MatrixX& half) {
    return matrix_product(half, VERNIER_LATER(columns).transpose());
  };
  MatrixX fixed = covariance_of(rows, matrix_product(rows, known.covariance));
  for (Index k = 0; k < fixed.rows(); ++k) fixed(k, k) += 1;
  constexpr double unknown = 1e4;  // times the expected size, squared: what the earlier calibration does not know
  fixed += covariance_of(others, unknown * others);
  const MatrixX geometry = VERNIER_LATER(rows).leftCols(known.geometric),
                joints = VERNIER_LATER(rows).rightCols(n - known.geometric);
  const MatrixX of_geometry =
      covariance_of(geometry, columns_scaled(geometry, VERNIER_LATER(known.expected).head(known.geometric)));
  const MatrixX of_joints =
      covariance_of(joints, columns_scaled(joints, VERNIER_LATER(known.expected).tail(n - known.geometric)));

  const auto freedom = static_cast<double>(std::max<Index>(1, values - others.cols()));
  PriorTransfer best{.name = {}};
  double highest = -std::numeric_limits<double>::infinity();
  MatrixX factor;
  VectorX whitened;
  for (const double g : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2})
    for (const double j : {0.02, 0.05, 0.1, 0.15, 0.2, 0.4, 0.8, 1.6}) {
      factor = fixed;
      factor += g * g * of_geometry;
      factor += j * j * of_joints;
      if (!cholesky(factor)) continue;
      whitened = error;
      solve_lower(factor, whitened);
      const double evidence =
          -0.5 * (freedom * std::log(whitened.squaredNorm() / freedom) + cholesky_log_determinant(factor));
      if (!(evidence > highest)) continue;
      highest = evidence;
      best.geometry = g;
      best.joints = j;
    }
  return best;
}

}  // namespace vernier::detail
