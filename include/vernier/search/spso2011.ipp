// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/spso2011.hpp"

namespace vernier {

VERNIER_IMPL bool Spso2011::State::consistent() const {
  return Swarm::consistent() &&
         (links.size() == 0 || (links.cols() == positions.cols() && VERNIER_LATER(links).minCoeff() >= 0 &&
                                VERNIER_LATER(links).maxCoeff() < positions.cols()));
}

VERNIER_IMPL Spso2011::State Spso2011::start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
  validate();
  State s;
  s.rng = Rng(seed);
  const auto velocity = [&](Index d, double x) { return s.rng.uniform(box.lower(d) - x, box.upper(d) - x); };
  s.initialise(box, particles, velocity, evaluate);
  return s;
}

VERNIER_IMPL void Spso2011::step(State& s, const Box& box, Evaluate evaluate) const {
  const Index dimension = s.positions.rows(), n = s.positions.cols();
  if (s.links.size() == 0) {
    s.links.resize(informed, n);
    for (Index i = 0; i < s.links.size(); ++i)
      s.links.data()[i] = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(n)));
  }
  const auto leaders = best_informants(s.best_values, s.links);
  VectorX direction(dimension), centre(dimension);
  for (Index k = 0; k < n; ++k) {
    const Index leader = leaders[static_cast<std::size_t>(k)];
    for (Index d = 0; d < dimension; ++d) {  // relative to x
      const double at = s.positions(d, k);
      centre(d) = acceleration / (leader == k ? 2 : 3) * (s.best_positions(d, k) - at);
      if (leader != k) centre(d) += acceleration / 3 * (s.best_positions(d, leader) - at);
    }
    for (Index d = 0; d < dimension; ++d) direction(d) = s.rng.normal();
    const double length = direction.norm(), radius = s.rng.uniform() * centre.norm();
    const double turn = length > 0 ? radius / length : 0;
    for (Index d = 0; d < dimension; ++d) {
      double& x = s.positions(d, k);
      double& v = s.velocities(d, k);
      v = inertia * v + centre(d) + turn * direction(d);
      x += v;
      if (x >= box.lower(d) && x <= box.upper(d)) continue;
      x = x < box.lower(d) ? box.lower(d) : box.upper(d);
      v *= -0.5;
    }
  }
  const double before = s.best_fitness;
  s.evaluate_and_update(evaluate);
  if (!(s.best_fitness < before)) s.links.resize(0, 0);
}

VERNIER_IMPL std::vector<Index> Spso2011::best_informants(const VectorX& values, const Links& links) {
  std::vector<Index> leaders(static_cast<std::size_t>(values.size()));
  for (Index k = 0; k < values.size(); ++k) leaders[static_cast<std::size_t>(k)] = k;
  for (Index k = 0; k < links.cols(); ++k)
    for (Index i = 0; i < links.rows(); ++i) {
      Index& leader = leaders[static_cast<std::size_t>(links(i, k))];
      if (values(k) < values(leader)) leader = k;
    }
  return leaders;
}

VERNIER_IMPL void Spso2011::validate() const {
  demand(particles >= 1, "Spso2011: particles is ", particles, ", must be at least 1");
  demand(iterations >= 0, "Spso2011: iterations is ", iterations, ", must not be negative");
}

}  // namespace vernier
