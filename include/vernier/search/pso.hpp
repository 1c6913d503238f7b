// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Particle swarm optimization: linearly decreasing inertia or constriction, a global best or neighbourhoods.

#include <cmath>

#include "vernier/search/swarm.hpp"

namespace vernier {

/// How particles are kept in the box, if at all.
enum class PositionRule {
  unbounded,  ///< only velocities are limited: particles start in the box and may leave it (as in the paper)
  clamped,    ///< a coordinate that would leave the box stops at the bound, its velocity zero: nothing outside is
              ///< evaluated
  reflected,  ///< a coordinate that would leave the box is reflected at the bound, its velocity reversed
};

/// The neighbourhood whose best attracts a particle; it always includes the particle itself.
enum class Neighbourhood {
  global,       ///< the whole swarm
  ring,         ///< particles k - 1 and k + 1, cyclically
  von_neumann,  ///< left, right, above and below on a torus, the most nearly square grid that all particles fill row by
                ///< row; for a prime number of particles a ring
};

/// Particle swarm optimization as in the paper:
/// `v <- w v + c1 r1 (p - x) + c2 r2 (g - x)`, r1 and r2 drawn per dimension, v limited, w decreasing linearly over the
/// iterations. All particles move, then all are evaluated (synchronous). With neighbourhoods g is the best position in
/// the memories of a particle's neighbours.
/// @cite Kennedy and Eberhart 1995; Shi and Eberhart 1998; Kennedy and Mendes 2002; Feng, Dong, Jin
struct Pso {
  int particles = 50;          ///< at least 1
  Index iterations = 300;      ///< generations after the first population
  double inertia_start = 0.9;  ///< w before the first iteration, `inertia(0)`
  double inertia_end = 0.4;    ///< w at the last iteration
  double cognitive = 2;        ///< c1, attraction to a particle's own best
  double social = 2;           ///< c2, attraction to the best of the swarm or neighbourhood
  double velocity_limit = 1;   ///< relative to half the width of the box: 1 is [-1, 1] for weights in [-1, 1]
  /// How particles are kept in the box.
  PositionRule positions = PositionRule::unbounded;
  /// Whose best attracts a particle.
  Neighbourhood neighbourhood = Neighbourhood::global;

  /// A swarm between two iterations.
  using State = Swarm;

  /// Constriction instead of decreasing inertia: chi = 0.72984, both attractions 2.05 chi for phi = 4.1, positions
  /// kept in the box.
  /// @cite Clerc and Kennedy 2002
  static Pso constriction() {
    constexpr double phi = 4.1;
    const double chi = 2 / (phi - 2 + std::sqrt(phi * phi - 4 * phi));
    return {.inertia_start = chi,
            .inertia_end = chi,
            .cognitive = chi * phi / 2,
            .social = chi * phi / 2,
            .positions = PositionRule::clamped};
  }

  /// Positions uniform in the box, velocities uniform within their limits.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= iterations; }

  /// All particles.
  Index next_evaluations(const State& s) const { return s.positions.cols(); }

  /// w(k), k = 1 .. iterations.
  double inertia(Index k) const {
    return inertia_start - (inertia_start - inertia_end) * static_cast<double>(k) /
                               static_cast<double>(iterations > 0 ? iterations : 1);
  }

  /// Number of columns of the grid of `Neighbourhood::von_neumann`: the smallest divisor of n that is not below its
  /// square root; n, a grid of one row, for the other neighbourhoods.
  VERNIER_API Index grid_columns(Index n) const;

  /// The particle with the best memory among k and its four neighbours on a torus with that many columns; k where none
  /// is better.
  VERNIER_API static Index informant(const VectorX& values, Index k, Index columns);

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/pso.ipp"
#endif
