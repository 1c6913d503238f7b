#pragma once

/// @file
/// What all particle swarms share: where particles are, how fast, and what they remember.

#include "vernier/search/state.hpp"

namespace vernier {

/// A swarm between two iterations.
struct Swarm : CommonState {
  MatrixX positions;       ///< dimension x particles
  MatrixX velocities;      ///< dimension x particles
  VectorX fitness;         ///< of `positions`
  MatrixX best_positions;  ///< best of each particle
  VectorX best_values;     ///< their fitness

  /// Positions uniform in the box, velocities as `velocity(d, x)` draws them at coordinate x of dimension d; evaluated.
  template <class Velocity>
  void place(const Box& box, Index particles, Velocity&& velocity, Evaluate evaluate) {
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

  /// Evaluates all positions and remembers what is better; a generation is over.
  void look(Evaluate evaluate) {
    evaluate(positions, fitness);
    for (Index k = 0; k < positions.cols(); ++k) {
      if (!(fitness(k) < best_values(k))) continue;
      best_values(k) = fitness(k);
      best_positions.col(k) = positions.col(k);
    }
    keep_best(positions, fitness);
    ++generation;
  }

  /// Lists the members.
  template <class Self, class Visit>
  static void each_member(Self& s, Visit&& visit) {
    CommonState::each_member(s, visit);
    visit("positions", s.positions);
    visit("velocities", s.velocities);
    visit("fitness", s.fitness);
    visit("best_positions", s.best_positions);
    visit("best_values", s.best_values);
  }

  /// Whether the sizes of the members agree.
  bool consistent() const {
    const Index n = best.size(), particles = positions.cols();
    return particles >= 1 && positions.rows() == n && velocities.rows() == n && velocities.cols() == particles &&
           best_positions.rows() == n && best_positions.cols() == particles && fitness.size() == particles &&
           best_values.size() == particles;
  }
};

}  // namespace vernier
