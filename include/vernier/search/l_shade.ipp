// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/l_shade.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "vernier/core/argsort.hpp"
#include "vernier/search/detail/trials.hpp"

namespace vernier {

VERNIER_IMPL bool LShade::State::consistent() const {
  return PointPopulation::consistent(4) && archive.rows() == best.size() && weights.size() >= 1 &&
         crossover_rates.size() == weights.size() && oldest >= 0 && oldest < weights.size();
}

VERNIER_IMPL LShade::State LShade::start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
  validate();
  State s;
  s.first_size =
      std::max<Index>(final_individuals, std::lround(individuals_per_dimension * static_cast<double>(box.dimension())));
  demand(max_evaluations >= s.first_size, "LShade: max_evaluations is ", max_evaluations,
         ", less than the first population of ", s.first_size);
  s.initialise(box, s.first_size, seed, evaluate);
  s.archive.resize(box.dimension(), 0);
  s.weights = s.crossover_rates = VectorX::Constant(memory, 0.5);
  s.evaluations = s.first_size;
  return s;
}

VERNIER_IMPL void LShade::step(State& s, const Box& box, Evaluate evaluate) const {
  const MatrixX& x = s.positions;
  const Index n = x.cols(), count = next_evaluations(s);
  const auto order = argsort(s.fitness);
  const auto leaders = static_cast<std::uint64_t>(
      std::min<Index>(n, std::max<Index>(2, std::lround(best_share * static_cast<double>(n)))));
  MatrixX trials(x.rows(), count);
  VectorX f(count), cr(count), values;
  for (Index k = 0; k < count; ++k) {
    const auto pair = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(s.weights.size())));
    const double rate = s.crossover_rates(pair);
    cr(k) = rate < 0 ? 0 : std::clamp(rate + 0.1 * s.rng.normal(), 0.0, 1.0);
    do {
      f(k) = (std::min)(1.0, s.weights(pair) + 0.1 * std::tan(std::numbers::pi * (s.rng.uniform() - 0.5)));
    } while (!(f(k) > 0));
    const Index leader = order[s.rng.below(leaders)], r1 = detail::index_besides(n, {k}, s.rng),
                r2 = detail::index_besides(n + s.archive.cols(), {k, r1}, s.rng);
    const double* other = r2 < n ? VERNIER_LATER(x).col(r2).data() : VERNIER_LATER(s.archive).col(r2 - n).data();
    const auto mutant = [&](Index d) {
      return x(d, k) + f(k) * (x(d, leader) - x(d, k)) + f(k) * (x(d, r1) - other[d]);
    };
    detail::cross_binomially(VERNIER_LATER(x).col(k).data(), mutant, cr(k), TrialRule::halfway, box, s.rng,
                             VERNIER_LATER(trials).col(k).data());
  }
  evaluate(trials, values);
  s.evaluations += count;
  s.keep_best(trials, values);
  remember(s, values, f, cr);
  replace(s, trials, values);
  shrink(s);
  ++s.generation;
}

VERNIER_IMPL Index LShade::individuals(Index first_size, Index evaluations) const {
  const double share = static_cast<double>(evaluations) / static_cast<double>(max_evaluations);
  return std::lround(static_cast<double>(first_size) + (final_individuals - static_cast<double>(first_size)) * share);
}

VERNIER_IMPL void LShade::remember(State& s, const VectorX& values, const VectorX& f, const VectorX& cr) {
  double largest = 0;  // finite improvement
  for (Index k = 0; k < values.size(); ++k)
    if (const double gain = s.fitness(k) - values(k); std::isfinite(gain)) largest = (std::max)(largest, gain);
  double f1 = 0, f2 = 0, cr1 = 0, cr2 = 0;
  bool any = false;
  for (Index k = 0; k < values.size(); ++k) {
    if (!(values(k) < s.fitness(k))) continue;
    any = true;
    const double gain = s.fitness(k) - values(k), w = std::isfinite(gain) ? gain : largest > 0 ? largest : 1;
    f1 += w * f(k);
    f2 += w * f(k) * f(k);
    cr1 += w * cr(k);
    cr2 += w * cr(k) * cr(k);
  }
  if (!any) return;
  double& rate = s.crossover_rates(s.oldest);
  rate = rate < 0 || !(cr1 > 0) ? -1 : cr2 / cr1;
  if (f1 > 0) s.weights(s.oldest) = f2 / f1;
  s.oldest = (s.oldest + 1) % s.weights.size();
}

VERNIER_IMPL void LShade::replace(State& s, const MatrixX& trials, const VectorX& values) const {
  const Index full = archive_size(s.positions.cols());
  MatrixX archive(s.archive.rows(), (std::max)(full, s.archive.cols()));
  Index filled = s.archive.cols();
  VERNIER_LATER(archive).leftCols(filled) = s.archive;
  for (Index k = 0; k < values.size(); ++k) {
    if (values(k) > s.fitness(k)) continue;
    if (values(k) < s.fitness(k) && full > 0) {
      const Index at = filled < full ? filled++ : static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(filled)));
      VERNIER_LATER(archive).col(at) = VERNIER_LATER(s.positions).col(k);
    }
    VERNIER_LATER(s.positions).col(k) = VERNIER_LATER(trials).col(k);
    s.fitness(k) = values(k);
  }
  s.archive = VERNIER_LATER(archive).leftCols(filled);
}

VERNIER_IMPL void LShade::shrink(State& s) const {
  const Index n = std::max<Index>(final_individuals, individuals(s.first_size, s.evaluations));
  if (n >= s.positions.cols()) return;
  const auto order = argsort(s.fitness);
  MatrixX positions(s.positions.rows(), n);
  VectorX fitness(n);
  for (Index k = 0; k < n; ++k) {
    VERNIER_LATER(positions).col(k) = VERNIER_LATER(s.positions).col(order[static_cast<std::size_t>(k)]);
    fitness(k) = s.fitness(order[static_cast<std::size_t>(k)]);
  }
  s.positions.swap(positions);
  s.fitness.swap(fitness);
  Index filled = s.archive.cols();
  for (; filled > archive_size(n); --filled)
    VERNIER_LATER(s.archive).col(static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(filled)))) =
        VERNIER_LATER(s.archive).col(filled - 1).eval();
  s.archive.conservativeResize(Eigen::NoChange, filled);
}

VERNIER_IMPL Index LShade::archive_size(Index individuals) const {
  return std::lround(archive_rate * static_cast<double>(individuals));
}

VERNIER_IMPL void LShade::validate() const {
  demand(individuals_per_dimension > 0 && individuals_per_dimension <= 1e6, "LShade: individuals_per_dimension is ",
         individuals_per_dimension, ", must lie in (0, 1e6]");
  demand(memory >= 1, "LShade: memory is ", memory, ", must be at least 1");
  demand(archive_rate >= 0 && archive_rate <= 1000, "LShade: archive_rate is ", archive_rate,
         ", must lie in [0, 1000]");
  demand(best_share >= 0 && best_share <= 1, "LShade: best_share is ", best_share, ", must lie in [0, 1]");
}

}  // namespace vernier
