// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/swarm.hpp"

namespace vernier {

VERNIER_IMPL void Swarm::initialise(const Box& box, Index particles, FunctionRef<double(Index, double)> velocity,
                                    Evaluate evaluate) {
  positions.resize(box.dimension(), particles);
  velocities.resize(box.dimension(), particles);
  for (Index k = 0; k < particles; ++k)
    for (Index d = 0; d < box.dimension(); ++d) {
      positions(d, k) = rng.uniform(box.lower(d), box.upper(d));
      velocities(d, k) = velocity(d, positions(d, k));
    }
  evaluate(positions, fitness);
  best_positions = positions;
  best_values = fitness;
  keep_best(positions, fitness);
}

VERNIER_IMPL void Swarm::evaluate_and_update(Evaluate evaluate) {
  evaluate(positions, fitness);
  for (Index k = 0; k < positions.cols(); ++k) {
    if (!(fitness(k) < best_values(k))) continue;
    best_values(k) = fitness(k);
    VERNIER_LATER(best_positions).col(k) = VERNIER_LATER(positions).col(k);
  }
  keep_best(positions, fitness);
  ++generation;
}

VERNIER_IMPL bool Swarm::consistent() const {
  const Index n = best.size(), particles = positions.cols();
  return particles >= 1 && positions.rows() == n && velocities.rows() == n && velocities.cols() == particles &&
         best_positions.rows() == n && best_positions.cols() == particles && fitness.size() == particles &&
         best_values.size() == particles;
}

}  // namespace vernier
