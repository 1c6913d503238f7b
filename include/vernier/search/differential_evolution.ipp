// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/differential_evolution.hpp"

#include "vernier/search/detail/trials.hpp"

namespace vernier {

VERNIER_IMPL DifferentialEvolution::State DifferentialEvolution::start(const Box& box, std::uint64_t seed,
                                                                       Evaluate evaluate) const {
  validate();
  State s;
  s.initialise(box, individuals, seed, evaluate);
  return s;
}

VERNIER_IMPL void DifferentialEvolution::step(State& s, const Box& box, Evaluate evaluate) const {
  const MatrixX& x = s.positions;
  const Index n = x.cols();
  MatrixX trials(x.rows(), n);
  for (Index k = 0; k < n; ++k) {
    const Index r1 = detail::index_besides(n, {k}, s.rng), r2 = detail::index_besides(n, {k, r1}, s.rng),
                r3 = detail::index_besides(n, {k, r1, r2}, s.rng);
    const double* from = base == DifferentialBase::best ? s.best.data() : VERNIER_LATER(x).col(r1).data();
    const auto mutant = [&](Index d) { return from[d] + weight * (x(d, r2) - x(d, r3)); };
    detail::cross_binomially(VERNIER_LATER(x).col(k).data(), mutant, crossover_probability, trials_outside, box, s.rng,
                             VERNIER_LATER(trials).col(k).data());
  }
  VectorX values;
  evaluate(trials, values);
  for (Index k = 0; k < n; ++k) {
    if (values(k) > s.fitness(k)) continue;
    VERNIER_LATER(s.positions).col(k) = VERNIER_LATER(trials).col(k);
    s.fitness(k) = values(k);
  }
  s.keep_best(trials, values);
  ++s.generation;
}

VERNIER_IMPL void DifferentialEvolution::validate() const {
  demand(individuals >= 4, "DifferentialEvolution: individuals is ", individuals, ", must be at least 4");
  demand(generations >= 0, "DifferentialEvolution: generations is ", generations, ", must not be negative");
  demand(weight > 0 && weight <= 10, "DifferentialEvolution: weight is ", weight, ", must lie in (0, 10]");
  demand(crossover_probability >= 0 && crossover_probability <= 1, "DifferentialEvolution: crossover_probability is ",
         crossover_probability, ", must lie in [0, 1]");
}

}  // namespace vernier
