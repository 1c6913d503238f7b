#pragma once

/// @file
/// Particle swarm optimization: linearly falling inertia or constriction, one leader or neighbourhoods.

#include <cmath>

#include "vernier/search/bounds.hpp"
#include "vernier/search/swarm.hpp"

namespace vernier {

/// What particle positions may do.
enum class PositionRule {
  unbounded,  ///< only velocities are limited: particles start in the box and may leave it (as the paper states it)
  clamped,    ///< a coordinate that would leave the box stops at the bound, its velocity zero: nothing outside is
              ///< evaluated
  reflected,  ///< a coordinate that would leave the box bounces off the bound, its velocity turned round
};

/// Whose best draws a particle. Neighbourhoods always include the particle itself.
enum class Neighbourhood {
  global,       ///< the best of the whole swarm
  ring,         ///< particles k - 1 and k + 1, the last one beside the first
  von_neumann,  ///< left, right, above, below on a torus, the most square grid that all particles fill row by row; a
                ///< prime number of them is a ring
};

/// Particle swarm optimization as the paper states it:
/// `v <- w v + c1 r1 (p - x) + c2 r2 (g - x)`, r1 and r2 drawn per dimension, v limited, w falling linearly over the
/// iterations. All particles move, then all are evaluated (synchronous). With neighbourhoods g is the best that any of
/// a particle's neighbours has seen.
/// @cite Kennedy and Eberhart 1995; Shi and Eberhart 1998; Kennedy and Mendes 2002; Feng, Dong, Jin
struct Pso {
  int particles = 50;          ///< at least 1
  Index iterations = 300;      ///< generations after the first population
  double inertia_start = 0.9;  ///< w before the first iteration, `inertia(0)`
  double inertia_end = 0.4;    ///< w at the last iteration
  double cognitive = 2;        ///< c1, pull towards a particle's own best
  double social = 2;           ///< c2, pull towards the best of the swarm or neighbourhood
  double velocity_limit = 1;   ///< relative to half the width of the box: 1 is [-1, 1] for weights in [-1, 1]
  /// What positions may do.
  PositionRule positions = PositionRule::unbounded;
  /// Who draws whom.
  Neighbourhood neighbourhood = Neighbourhood::global;

  /// A swarm between two iterations.
  using State = Swarm;

  /// Constriction instead of falling inertia: chi = 0.72984 and both pulls chi 2.05 for phi = 4.1, positions kept in
  /// the box.
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
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.rng = Rng(seed);
    const VectorX limit = velocity_limit * (box.upper - box.lower) / 2;
    s.place(
        box, particles, [&](Index d, double) { return s.rng.uniform(-limit(d), limit(d)); }, evaluate);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const double w = inertia(s.generation + 1);
    const VectorX limit = velocity_limit * (box.upper - box.lower) / 2;
    const Index n = s.positions.cols(), columns = grid_columns(n);
    for (Index k = 0; k < n; ++k) {
      const double* leader = s.best.data();
      if (neighbourhood != Neighbourhood::global)
        leader = s.best_positions.col(informant(s.best_values, k, columns)).data();
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
          // an odd number of bounces turns the velocity round
          if (std::fmod(std::floor((x - box.lower(d)) / (box.upper(d) - box.lower(d))), 2) != 0) v = -v;
          x = reflected(x, box.lower(d), box.upper(d));
        }
      }
    }
    s.look(evaluate);
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= iterations; }

  /// w(k), k = 1 .. iterations.
  double inertia(Index k) const {
    return inertia_start - (inertia_start - inertia_end) * static_cast<double>(k) /
                               static_cast<double>(iterations > 0 ? iterations : 1);
  }

  /// Columns of the grid of `Neighbourhood::von_neumann`: the least divisor of n not below its square root; a ring is a
  /// grid of one row.
  Index grid_columns(Index n) const {
    if (neighbourhood != Neighbourhood::von_neumann) return n;
    Index rows = static_cast<Index>(std::sqrt(static_cast<double>(n)));
    while (n % rows != 0) --rows;
    return n / rows;
  }

  /// The particle with the best memory among k and its neighbours on a torus of so many columns; k where it has none
  /// better.
  static Index informant(const VectorX& values, Index k, Index columns) {
    const Index n = values.size(), row = k / columns * columns, column = k - row;
    Index leader = k;
    for (const Index neighbour : {row + (column + columns - 1) % columns, row + (column + 1) % columns,
                                  (k + n - columns) % n, (k + columns) % n})
      if (values(neighbour) < values(leader)) leader = neighbour;
    return leader;
  }

 private:
  void validate() const {
    require(particles >= 1, "Pso: particles is ", particles, ", must be at least 1");
    require(iterations >= 0, "Pso: iterations is ", iterations, ", must not be negative");
    require(velocity_limit > 0 && velocity_limit < 1e6, "Pso: velocity_limit is ", velocity_limit,
            ", must be positive and below 1e6");
    require(inertia_start >= 0 && inertia_end >= 0 && cognitive >= 0 && social >= 0, "Pso: inertia_start ",
            inertia_start, ", inertia_end ", inertia_end, ", cognitive ", cognitive, " and social ", social,
            " must not be negative");
  }
};

}  // namespace vernier
