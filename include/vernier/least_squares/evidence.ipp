// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/evidence.hpp"

namespace vernier {

namespace detail {

/// The minimum of residuals and priors, and the values left to determine the noise; with those of the sensor.
struct PenalisedMinimum {
  double cost, freedom;
};

VERNIER_LOCAL PenalisedMinimum penalised_minimum(const NormalEquations& normal, const FactorisedEquations& solved,
                                                 const VectorX& precisions, const VectorX& steps, Index values,
                                                 const VectorX& local_steps) {
  double at_present = normal.cost + local_prior_cost(normal, local_steps);
  double gain = local_gain(normal, solved.local_step(), local_steps);
  double without_prior = -static_cast<double>(normal.prior_unknowns);
  for (Index k = 0; k < steps.size(); ++k) {
    at_present += precisions(k) * steps(k) * steps(k);
    gain += solved.step()(k) * (normal.gradient(k) + precisions(k) * steps(k));
    if (precisions(k) <= 0) without_prior += 1;
  }
  return {(std::max)(at_present + gain, 0.0) + sensor_values,
          (std::max)(1.0, static_cast<double>(values) - without_prior) + sensor_values};
}

/// log determinant of the precisions of local unknowns.
VERNIER_LOCAL double local_prior_log_determinant(const NormalEquations& normal) {
  if (normal.local.size == 0) return 0;
  MatrixX none = MatrixX::Zero(normal.local.size, 1);
  return eigen_sparse_solver(normal.local_prior, none).log_determinant;
}

}  // namespace detail

VERNIER_IMPL double log_evidence(const NormalEquations& normal, const FactorisedEquations& solved,
                                 const VectorX& precisions, const VectorX& steps, Index values,
                                 const VectorX& local_steps) {
  if (!solved.usable()) return -std::numeric_limits<double>::infinity();
  const auto [cost, freedom] = detail::penalised_minimum(normal, solved, precisions, steps, values, local_steps);
  double of_priors = detail::local_prior_log_determinant(normal);
  for (const double precision : precisions)
    if (precision > 0) of_priors += std::log(precision);
  return -0.5 * (freedom * std::log(cost / freedom) + solved.log_determinant() - of_priors);
}

namespace detail {

/// Evidence over a factor on the priors of a few unknowns, up to a constant, from one factorisation: their marginal
/// normal distribution is all that the factor acts on.
class ScaledEvidence {
 public:
  VERNIER_LOCAL ScaledEvidence(const NormalEquations& normal, const VectorX& precisions, const VectorX& steps,
                               Index values, const UnknownGroup& group, const VectorX& local_steps)
      : size_(static_cast<Index>(group.size())) {
    const FactorisedEquations solved(normal, precisions, steps, local_steps);
    if (!solved.usable()) return;
    minimum_ = penalised_minimum(normal, solved, precisions, steps, values, local_steps);
    MatrixX columns = MatrixX::Zero(precisions.size(), size_);
    value_.resize(size_, 1);
    for (Index k = 0; k < size_; ++k) {
      const Index unknown = group[static_cast<std::size_t>(k)];
      const double root = std::sqrt(precisions(unknown));
      columns(unknown, k) = root;
      value_(k, 0) = root * (steps(unknown) + solved.step()(unknown));
    }
    solved.apply_inverse_factor(columns);
    share_ = transposed_matrix_product(columns, columns);
    usable_ = true;
  }

  VERNIER_LOCAL double operator()(double factor) const {
    if (!usable_) return -std::numeric_limits<double>::infinity();
    MatrixX change = (factor - 1) * share_, value = value_;
    for (Index k = 0; k < size_; ++k) change(k, k) += 1;
    if (!cholesky(change)) return -std::numeric_limits<double>::infinity();
    solve_lower(change, value);
    const double cost = (std::max)(minimum_.cost + (factor - 1) * value.squaredNorm(), 1e-300);
    return -0.5 * (minimum_.freedom * std::log(cost) + cholesky_log_determinant(change) -
                   static_cast<double>(size_) * std::log(factor));
  }

 private:
  Index size_;
  PenalisedMinimum minimum_{};
  MatrixX share_, value_;  // of the posterior in the prior's units
  bool usable_ = false;
};

}  // namespace detail

VERNIER_IMPL VectorX scale_priors(const NormalEquations& normal, const VectorX& precisions, const VectorX& steps,
                                  Index values, const UnknownGroup& group, const VectorX& local_steps) {
  const auto scaled = [&](double factor) {
    VectorX out = precisions;
    for (const Index k : group) out(k) *= factor;
    return out;
  };
  constexpr std::size_t few = 256;
  std::optional<detail::ScaledEvidence> of_few;
  std::optional<FactorisedEquations> solved;
  if (group.size() <= few)
    of_few = detail::ScaledEvidence(normal, precisions, steps, values, group, local_steps);
  else
    solved.emplace(normal, precisions, steps, local_steps);
  const auto evidence = [&](double factor) {
    if (of_few) return (*of_few)(factor);
    const VectorX now = scaled(factor);
    return log_evidence(normal, solved->with(now, steps), now, steps, values, local_steps);
  };
  double best = 1, highest = evidence(1);
  for (const double step : {16.0, 4.0, 2.0, std::sqrt(2.0)})
    for (const double towards : {step, 1 / step})
      for (double factor = best * towards; factor > 1e-6 && factor < 1e9; factor *= towards) {
        const double reached = evidence(factor);
        if (!(reached > highest)) break;
        highest = reached;
        best = factor;
      }
  return scaled(best);
}

VERNIER_IMPL VectorX learn_priors(const NormalEquations& normal, VectorX precisions, const VectorX& steps, Index values,
                                  const std::vector<UnknownGroup>& groups, int iterations, const VectorX& local_steps) {
  if (iterations < 1) return precisions;
  FactorisedEquations solved(normal, precisions, steps, local_steps);
  for (int i = 0; solved.usable(); ++i) {
    const auto [cost, freedom] = detail::penalised_minimum(normal, solved, precisions, steps, values, local_steps);
    const VectorX variance = solved.inverse_diagonal(), z = steps + solved.step();
    for (const UnknownGroup& group : groups) {
      double determined = 0, squares = 0;  // number of unknowns that the data determine, not the priors
      for (const Index k : group) {
        determined += 1 - precisions(k) * variance(k);
        squares += precisions(k) * z(k) * z(k);
      }
      const double factor =
          std::clamp((std::max)(determined, 1e-3) * cost / freedom / (std::max)(squares, 1e-300), 0.1, 10.0);
      for (const Index k : group) precisions(k) = (std::min)(precisions(k) * factor, 1e9);
    }
    if (i + 1 == iterations) break;
    solved = solved.with(precisions, steps);
  }
  return precisions;
}

}  // namespace vernier
