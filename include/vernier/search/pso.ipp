// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/pso.hpp"

#include <cmath>

#include "vernier/core/same_value.hpp"
#include "vernier/search/bounds.hpp"

namespace vernier {

VERNIER_IMPL Pso::State Pso::start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
  validate();
  State s;
  s.rng = Rng(seed);
  VectorX limit = box.upper - box.lower;
  limit *= velocity_limit / 2;
  const auto velocity = [&](Index d, double) { return s.rng.uniform(-limit(d), limit(d)); };
  s.initialise(box, particles, velocity, evaluate);
  return s;
}

VERNIER_IMPL void Pso::step(State& s, const Box& box, Evaluate evaluate) const {
  const double w = inertia(s.generation + 1);
  VectorX limit = box.upper - box.lower;
  limit *= velocity_limit / 2;
  const Index n = s.positions.cols(), columns = grid_columns(n);
  for (Index k = 0; k < n; ++k) {
    const double* leader = s.best.data();
    if (neighbourhood != Neighbourhood::global)
      leader = VERNIER_LATER(s.best_positions).col(informant(s.best_values, k, columns)).data();
    for (Index d = 0; d < s.positions.rows(); ++d) {
      double& x = s.positions(d, k);
      double& v = s.velocities(d, k);
      const double r1 = s.rng.uniform(), r2 = s.rng.uniform();
      v = w * v + cognitive * r1 * (s.best_positions(d, k) - x) + social * r2 * (leader[d] - x);
      v = v < -limit(d) ? -limit(d) : v > limit(d) ? limit(d) : v;
      x += v;
      if (positions == PositionRule::unbounded || (x >= box.lower(d) && x <= box.upper(d))) continue;
      if (positions == PositionRule::clamped) {
        x = x < box.lower(d) ? box.lower(d) : box.upper(d);
        v = 0;
      } else {
        // an odd number of reflections reverses the velocity
        if (!same_value(std::fmod(std::floor((x - box.lower(d)) / (box.upper(d) - box.lower(d))), 2), 0)) v = -v;
        x = reflected(x, box.lower(d), box.upper(d));
      }
    }
  }
  s.evaluate_and_update(evaluate);
}

VERNIER_IMPL Index Pso::grid_columns(Index n) const {
  if (neighbourhood != Neighbourhood::von_neumann) return n;
  Index rows = static_cast<Index>(std::sqrt(static_cast<double>(n)));
  while (n % rows != 0) --rows;
  return n / rows;
}

VERNIER_IMPL Index Pso::informant(const VectorX& values, Index k, Index columns) {
  const Index n = values.size(), row = k / columns * columns, column = k - row;
  Index leader = k;
  for (const Index neighbour :
       {row + (column + columns - 1) % columns, row + (column + 1) % columns, (k + n - columns) % n, (k + columns) % n})
    if (values(neighbour) < values(leader)) leader = neighbour;
  return leader;
}

VERNIER_IMPL void Pso::validate() const {
  demand(particles >= 1, "Pso: particles is ", particles, ", must be at least 1");
  demand(iterations >= 0, "Pso: iterations is ", iterations, ", must not be negative");
  demand(velocity_limit > 0 && velocity_limit < 1e6, "Pso: velocity_limit is ", velocity_limit,
         ", must be positive and below 1e6");
  demand(inertia_start >= 0 && inertia_end >= 0 && cognitive >= 0 && social >= 0, "Pso: inertia_start ", inertia_start,
         ", inertia_end ", inertia_end, ", cognitive ", cognitive, " and social ", social, " must not be negative");
}

}  // namespace vernier
