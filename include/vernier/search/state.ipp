// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/state.hpp"

namespace vernier {

VERNIER_IMPL void CommonState::keep_best(const MatrixX& population, const VectorX& fitness) {
  Index leader = 0;
  const double value = VERNIER_LATER(fitness).minCoeff(&leader);
  if (!(value < best_fitness) && best.size() > 0) return;
  best_fitness = value;
  best = VERNIER_LATER(population).col(leader);
}

VERNIER_IMPL MatrixX uniform_points(const Box& box, Index count, Rng& rng) {
  MatrixX points(box.dimension(), count);
  for (Index k = 0; k < count; ++k)
    for (Index d = 0; d < points.rows(); ++d) points(d, k) = rng.uniform(box.lower(d), box.upper(d));
  return points;
}

VERNIER_IMPL void PointPopulation::initialise(const Box& box, Index individuals, std::uint64_t seed,
                                              Evaluate evaluate) {
  rng = Rng(seed);
  positions = uniform_points(box, individuals, rng);
  evaluate(positions, fitness);
  keep_best(positions, fitness);
}

}  // namespace vernier
