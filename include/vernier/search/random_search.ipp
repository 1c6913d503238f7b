// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/random_search.hpp"

namespace vernier {

VERNIER_IMPL RandomSearch::State RandomSearch::start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
  demand(individuals >= 1, "RandomSearch: individuals is ", individuals, ", must be at least 1");
  demand(generations >= 0, "RandomSearch: generations is ", generations, ", must not be negative");
  State s;
  s.rng = Rng(seed);
  step(s, box, evaluate);
  s.generation = 0;
  return s;
}

VERNIER_IMPL void RandomSearch::step(State& s, const Box& box, Evaluate evaluate) const {
  const MatrixX points = uniform_points(box, individuals, s.rng);
  VectorX fitness;
  evaluate(points, fitness);
  s.keep_best(points, fitness);
  ++s.generation;
}

}  // namespace vernier
