#pragma once

/// @file
/// Particle swarm optimization with a global best and linearly falling inertia.

#include "vernier/core/rng.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// What particle positions may do.
enum class PositionRule {
  unbounded,  ///< only velocities are limited: particles start in the box and may leave it (as the paper states it)
  clamped,    ///< a coordinate that would leave the box stops at the bound, its velocity zero: nothing outside is
              ///< evaluated
};

/// Particle swarm optimization as the paper states it:
/// `v <- w v + c1 r1 (p - x) + c2 r2 (g - x)`, r1 and r2 drawn per dimension, v limited, w falling linearly over the
/// iterations. All particles move, then all are evaluated (synchronous).
/// @cite Kennedy and Eberhart 1995; Shi and Eberhart 1998; Feng, Dong, Jin
struct Pso {
  int particles = 50;          ///< at least 1
  Index iterations = 300;      ///< generations after the first population
  double inertia_start = 0.9;  ///< w before the first iteration, `inertia(0)`
  double inertia_end = 0.4;    ///< w at the last iteration
  double cognitive = 2;        ///< c1, pull towards a particle's own best
  double social = 2;           ///< c2, pull towards the swarm's best
  double velocity_limit = 1;   ///< relative to half the width of the box: 1 is [-1, 1] for weights in [-1, 1]
  /// What positions may do.
  PositionRule positions = PositionRule::unbounded;

  /// A swarm between two iterations.
  struct State {
    MatrixX positions;       ///< dimension x particles
    MatrixX velocities;      ///< dimension x particles
    VectorX fitness;         ///< of `positions`
    MatrixX best_positions;  ///< best of each particle
    VectorX best_values;     ///< their fitness
    VectorX best;            ///< best of all
    /// Its value.
    double best_fitness = 0;
    /// Generations stepped.
    Index generation = 0;
    /// Source of all randomness.
    Rng rng;
  };

  /// Positions uniform in the box, velocities uniform within their limits.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.rng = Rng(seed);
    s.positions.resize(box.dimension(), particles);
    s.velocities.resize(box.dimension(), particles);
    for (Index k = 0; k < particles; ++k)
      for (Index d = 0; d < box.dimension(); ++d) {
        const double limit = velocity_limit * (box.upper(d) - box.lower(d)) / 2;
        s.positions(d, k) = s.rng.uniform(box.lower(d), box.upper(d));
        s.velocities(d, k) = s.rng.uniform(-limit, limit);
      }
    evaluate(s.positions, s.fitness);
    s.best_positions = s.positions;
    s.best_values = s.fitness;
    Index leader = 0;
    s.best_fitness = s.fitness.minCoeff(&leader);
    s.best = s.positions.col(leader);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const double w = inertia(s.generation + 1);
    const VectorX limit = velocity_limit * (box.upper - box.lower) / 2;
    for (Index k = 0; k < s.positions.cols(); ++k)
      for (Index d = 0; d < s.positions.rows(); ++d) {
        double& x = s.positions(d, k);
        double& v = s.velocities(d, k);
        const double r1 = s.rng.uniform(), r2 = s.rng.uniform();
        v = w * v + cognitive * r1 * (s.best_positions(d, k) - x) + social * r2 * (s.best(d) - x);
        v = v < -limit(d) ? -limit(d) : v > limit(d) ? limit(d) : v;
        x += v;
        if (positions == PositionRule::clamped && (x < box.lower(d) || x > box.upper(d))) {
          x = x < box.lower(d) ? box.lower(d) : box.upper(d);
          v = 0;
        }
      }
    evaluate(s.positions, s.fitness);
    for (Index k = 0; k < s.positions.cols(); ++k) {
      if (!(s.fitness(k) < s.best_values(k))) continue;
      s.best_values(k) = s.fitness(k);
      s.best_positions.col(k) = s.positions.col(k);
      if (s.fitness(k) < s.best_fitness) {
        s.best_fitness = s.fitness(k);
        s.best = s.positions.col(k);
      }
    }
    ++s.generation;
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= iterations; }

  /// w(k), k = 1 .. iterations.
  double inertia(Index k) const {
    return inertia_start - (inertia_start - inertia_end) * static_cast<double>(k) /
                               static_cast<double>(iterations > 0 ? iterations : 1);
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
