// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/cma_es.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vernier/core/argsort.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/search/bounds.hpp"

namespace vernier {

VERNIER_IMPL CmaEsConstants::CmaEsConstants(Index dimension, Index individuals)
    : weights(individuals), mu(individuals / 2) {
  const auto n = static_cast<double>(dimension);
  for (Index i = 0; i < individuals; ++i)
    weights(i) = std::log((static_cast<double>(individuals) + 1) / 2) - std::log(static_cast<double>(i + 1));
  const auto effective = [](const VectorX& w) { return w.sum() * w.sum() / w.squaredNorm(); };
  VectorX better = VERNIER_LATER(weights).head(mu), worse = VERNIER_LATER(weights).tail(individuals - mu);
  mu_eff = effective(better);
  c_c = (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n);
  c_1 = 2 / ((n + 1.3) * (n + 1.3) + mu_eff);
  c_mu = (std::min)(1 - c_1, 2 * (0.25 + mu_eff + 1 / mu_eff - 2) / ((n + 2) * (n + 2) + mu_eff));
  c_sigma = (mu_eff + 2) / (n + mu_eff + 5);
  d_sigma = 1 + 2 * (std::max)(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_sigma;
  expected_norm = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
  better /= better.sum();
  if (const double sum = -worse.sum(); sum > 0) {
    const double of_worse = effective(worse);
    worse *=
        (std::max)(0.0, (std::min)({1 + c_1 / c_mu, 1 + 2 * of_worse / (mu_eff + 2), (1 - c_1 - c_mu) / (n * c_mu)})) /
        sum;
  }
  VERNIER_LATER(weights).head(mu) = better;
  VERNIER_LATER(weights).tail(individuals - mu) = worse;
}

VERNIER_IMPL bool CmaEs::State::consistent() const {
  const Index n = best.size();
  const auto square = [n](const MatrixX& m) { return m.rows() == n && m.cols() == n; };
  return square(covariance) && square(basis) && mean.size() == n && scales.size() == n && path_c.size() == n &&
         path_sigma.size() == n && individuals >= 2;
}

VERNIER_IMPL CmaEs::State CmaEs::start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
  validate();
  State s;
  s.rng = Rng(seed);
  s.mean.resize(box.dimension());
  begin_run(s);
  sample_and_update(s, box, evaluate);
  return s;
}

VERNIER_IMPL void CmaEs::step(State& s, const Box& box, Evaluate evaluate) const {
  if (s.converged) {
    ++s.run;
    begin_run(s);
  }
  sample_and_update(s, box, evaluate);
  ++s.generation;
}

/// Standard normal draws, one a column, as draws of the distribution. Column by column, so that a search goes on to the
/// same bits on a machine with other vector instructions.
VERNIER_IMPL MatrixX CmaEs::stretched(const State& s, const MatrixX& z) {
  const MatrixX scaled = detail::rows_scaled(s.scales, z);
  MatrixX out(z.rows(), z.cols());
  for (Index k = 0; k < z.cols(); ++k)
    VERNIER_LATER(out).col(k) = detail::product(s.basis, VERNIER_LATER(scaled).col(k));
  return out;
}

VERNIER_IMPL Index CmaEs::population_size(Index dimension, Index run) const {
  const auto first =
      individuals > 0 ? static_cast<double>(individuals) : 4 + std::floor(3 * std::log(static_cast<double>(dimension)));
  return std::lround(first * std::pow(growth, static_cast<double>(run)));
}

VERNIER_IMPL void CmaEs::update(State& s, const MatrixX& z, const std::vector<Index>& order) {
  const Index n = s.mean.size(), lambda = z.cols();
  const CmaEsConstants c(n, lambda);
  MatrixX sorted(n, lambda);
  for (Index i = 0; i < lambda; ++i)
    VERNIER_LATER(sorted).col(i) = VERNIER_LATER(z).col(order[static_cast<std::size_t>(i)]);
  const VectorX z_mean = detail::product(VERNIER_LATER(sorted).leftCols(c.mu), VERNIER_LATER(c.weights).head(c.mu));
  const VectorX y_mean = detail::product(s.basis, VERNIER_LATER(s.scales).cwiseProduct(z_mean));
  s.mean += s.sigma * y_mean;
  ++s.updates;

  const VectorX turned = detail::product(s.basis, z_mean);  // C^-1/2 y = B z
  s.path_sigma *= 1 - c.c_sigma;
  s.path_sigma += std::sqrt(c.c_sigma * (2 - c.c_sigma) * c.mu_eff) * turned;
  const double length = s.path_sigma.norm();
  const double settled = std::sqrt(1 - std::pow(1 - c.c_sigma, 2.0 * static_cast<double>(s.updates)));
  const bool moderate = length / settled < (1.4 + 2 / (static_cast<double>(n) + 1)) * c.expected_norm;
  s.path_c *= 1 - c.c_c;
  if (moderate) s.path_c += std::sqrt(c.c_c * (2 - c.c_c) * c.mu_eff) * y_mean;

  VectorX weights = c.weights;  // worse points count by direction, not by length: C stays positive definite
  const VectorX squares = detail::squared_column_norms(sorted);
  for (Index i = c.mu; i < lambda; ++i) weights(i) *= static_cast<double>(n) / (std::max)(squares(i), 1e-300);
  const MatrixX y = stretched(s, sorted);
  s.covariance *= 1 - c.c_1 - c.c_mu * c.weights.sum() + (moderate ? 0 : c.c_1 * c.c_c * (2 - c.c_c));
  const auto add_square = [&](double weight, const double* x) {
    for (Index j = 0; j < n; ++j) {
      const double of_j = x[j];
      for (Index i = 0; i < n; ++i) s.covariance(i, j) += weight * (x[i] * of_j);
    }
  };
  add_square(c.c_1, s.path_c.data());
  for (Index k = 0; k < lambda; ++k) add_square(c.c_mu * weights(k), VERNIER_LATER(y).col(k).data());
  s.sigma *= std::exp((std::min)(1.0, c.c_sigma / c.d_sigma * (length / c.expected_norm - 1)));

  if (static_cast<double>(s.updates - s.decomposed) > 1 / ((c.c_1 + c.c_mu) * static_cast<double>(n) * 10)) {
    const detail::SymmetricEigen eigen = detail::symmetric_eigen(s.covariance);
    const VectorX& values = eigen.values;
    if (!eigen.converged || !(values(0) > 1e-14 * values(n - 1))) {
      s.converged = true;
      return;
    }
    s.basis = eigen.vectors;
    s.scales = VERNIER_LATER(values).cwiseSqrt();
    s.decomposed = s.updates;
  }
}

VERNIER_IMPL void CmaEs::begin_run(State& s) const {
  const Index n = s.mean.size();
  s.individuals = population_size(n, s.run);
  for (auto& coordinate : s.mean) coordinate = s.rng.uniform();
  s.sigma = sigma;
  s.covariance = s.basis = MatrixX::Identity(n, n);
  s.scales = VectorX::Ones(n);
  s.path_c = s.path_sigma = VectorX::Zero(n);
  s.history.resize(0);
  s.updates = s.decomposed = 0;
  s.converged = false;
}

VERNIER_IMPL void CmaEs::sample_and_update(State& s, const Box& box, Evaluate evaluate) const {
  const Index n = s.mean.size(), lambda = s.individuals;
  MatrixX z(n, lambda);
  for (Index i = 0; i + 1 < z.size(); i += 2) {
    const auto pair = s.rng.normal_pair();
    std::copy(pair.begin(), pair.end(), z.data() + i);
  }
  if (z.size() % 2 != 0) z.data()[z.size() - 1] = s.rng.normal();
  MatrixX points = stretched(s, z);
  for (Index k = 0; k < lambda; ++k)
    for (Index d = 0; d < n; ++d) {
      const double at = reflected(s.mean(d) + s.sigma * points(d, k), 0, 1);
      points(d, k) = std::clamp(box.lower(d) + (box.upper(d) - box.lower(d)) * at, box.lower(d), box.upper(d));
    }
  VectorX fitness;
  evaluate(points, fitness);
  s.keep_best(points, fitness);
  const auto order = argsort(fitness);
  update(s, z, order);
  check_convergence(s, fitness(order.front()), fitness(order.back()));
}

VERNIER_IMPL void CmaEs::check_convergence(State& s, double best, double worst) const {
  const Index n = s.mean.size(), length = 10 + (30 * n + s.individuals - 1) / s.individuals;
  if (s.history.size() == length) std::copy(s.history.begin() + 1, s.history.end(), s.history.begin());
  if (s.history.size() < length) s.history.conservativeResize(s.history.size() + 1);
  s.history(s.history.size() - 1) = best;
  const auto within = [&](double a, double b) { return same_value(a, b) || std::abs(a - b) <= tolerance_f; };
  const bool flat = s.history.size() == length &&
                    within(VERNIER_LATER(s.history).minCoeff(), VERNIER_LATER(s.history).maxCoeff()) &&
                    within(best, worst);
  const double spread = s.sigma * (std::max)({VERNIER_LATER(s.path_c).maxCoeff(), -VERNIER_LATER(s.path_c).minCoeff(),
                                              std::sqrt(detail::diagonal_of(s.covariance).maxCoeff())});
  s.converged = s.converged || flat || !(spread >= tolerance_x) || !(spread < 1e6);
}

VERNIER_IMPL void CmaEs::validate() const {
  demand(individuals == 0 || individuals >= 2, "CmaEs: individuals is ", individuals, ", must be 0 or at least 2");
  demand(generations >= 0, "CmaEs: generations is ", generations, ", must not be negative");
  demand(sigma > 0 && sigma <= 100, "CmaEs: sigma is ", sigma, ", must lie in (0, 100]");
  demand(restarts >= 0 && restarts <= 30, "CmaEs: restarts is ", restarts, ", must lie in 0..30");
  demand(growth >= 1 && growth <= 10, "CmaEs: growth is ", growth, ", must lie in [1, 10]");
  demand(tolerance_x >= 0 && tolerance_f >= 0, "CmaEs: tolerance_x ", tolerance_x, " and tolerance_f ", tolerance_f,
         " must not be negative");
}

}  // namespace vernier
