// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The state of particle swarms: positions, velocities and each particle's best.

#include "vernier/search/state.hpp"

namespace vernier {

/// A swarm between two iterations.
struct Swarm : CommonState {
  MatrixX positions;       ///< dimension x particles
  MatrixX velocities;      ///< dimension x particles
  VectorX fitness;         ///< of `positions`
  MatrixX best_positions;  ///< best of each particle
  VectorX best_values;     ///< their fitness

  /// Positions drawn uniformly from the box, evaluated; velocities from `velocity(d, x)`, called for each coordinate x
  /// in dimension d.
  VERNIER_API void initialise(const Box& box, Index particles, FunctionRef<double(Index, double)> velocity,
                              Evaluate evaluate);

  /// Evaluates all positions and updates each particle's best; ends a generation.
  VERNIER_API void evaluate_and_update(Evaluate evaluate);

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
  VERNIER_API bool consistent() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/swarm.ipp"
#endif
