#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/evidence.hpp"

namespace vernier {

namespace detail {

/// The minimum of residuals and priors, and the values left to determine the noise.
struct PenalisedMinimum {
  double cost, freedom;
};

VERNIER_API PenalisedMinimum penalised_minimum(const NormalEquations& normal, const FactorisedEquations& solved,
                                               const VectorX& precisions, const VectorX& steps, Index values,
                                               const VectorX& local_steps) {
  const double at_present = normal.cost + precisions.dot(steps.cwiseAbs2()) + local_prior_cost(normal, local_steps);
  const double gain = solved.step().dot(normal.gradient + precisions.cwiseProduct(steps)) +
                      local_gain(normal, solved.local_step(), local_steps);
  const auto without_prior = static_cast<double>((precisions.array() <= 0).count());
  return {std::max(at_present + gain, 1e-300), std::max(1.0, static_cast<double>(values) - without_prior)};
}

/// log determinant of the precisions of local unknowns.
VERNIER_API double local_prior_log_determinant(const NormalEquations& normal) {
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

VERNIER_IMPL VectorX scale_priors(const NormalEquations& normal, const VectorX& precisions, const VectorX& steps,
                                  Index values, const UnknownGroup& group, const VectorX& local_steps) {
  const auto scaled = [&](double factor) {
    VectorX out = precisions;
    for (const Index k : group) out(k) *= factor;
    return out;
  };
  const auto evidence = [&](double factor) {
    const VectorX now = scaled(factor);
    return log_evidence(normal, FactorisedEquations(normal, now, steps, local_steps), now, steps, values, local_steps);
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
  for (int i = 0; i < iterations; ++i) {
    const FactorisedEquations solved(normal, precisions, steps, local_steps);
    if (!solved.usable()) return precisions;
    const auto [cost, freedom] = detail::penalised_minimum(normal, solved, precisions, steps, values, local_steps);
    const VectorX variance = solved.inverse_diagonal(), z = steps + solved.step();
    for (const UnknownGroup& group : groups) {
      double determined = 0, squares = 0;  // number of unknowns that the data determine, not the priors
      for (const Index k : group) {
        determined += 1 - precisions(k) * variance(k);
        squares += precisions(k) * z(k) * z(k);
      }
      const double factor =
          std::clamp(std::max(determined, 1e-3) * cost / freedom / std::max(squares, 1e-300), 0.1, 10.0);
      for (const Index k : group) precisions(k) = std::min(precisions(k) * factor, 1e9);
    }
  }
  return precisions;
}

}  // namespace vernier
