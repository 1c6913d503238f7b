// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Common parts of the states of all searches.

#include <concepts>
#include <cstdint>
#include <limits>

#include "vernier/core/rng.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// The part of a state that all searches of this library have. States derive from it and list all their members with
/// `each_member(state, visit)`, `visit(name, member)`: what is saved and loaded.
struct CommonState {
  VectorX best;  ///< best point evaluated
  /// Its value.
  double best_fitness = std::numeric_limits<double>::infinity();
  /// Generations stepped.
  Index generation = 0;
  /// Source of all randomness.
  Rng rng{};

  /// Updates the best point from a population just evaluated, where that has a better one; from the very first
  /// population always.
  VERNIER_API void keep_best(const MatrixX& population, const VectorX& fitness);

  /// Lists the members.
  template <class Self, class Visit>
  static void each_member(Self& s, Visit&& visit) {
    visit("best", s.best);
    visit("best_fitness", s.best_fitness);
    visit("generation", s.generation);
    visit("rng", s.rng);
  }
};

/// Points drawn uniformly from a box, one per column, coordinate by coordinate.
VERNIER_API MatrixX uniform_points(const Box& box, Index count, Rng& rng);

/// A population of points between two generations.
struct PointPopulation : CommonState {
  MatrixX positions;  ///< dimension x individuals
  VectorX fitness;    ///< one value per individual

  /// Individuals drawn uniformly from the box, evaluated.
  VERNIER_API void initialise(const Box& box, Index individuals, std::uint64_t seed, Evaluate evaluate);

  /// Lists the members.
  template <class Self, class Visit>
  static void each_member(Self& s, Visit&& visit) {
    CommonState::each_member(s, visit);
    visit("positions", s.positions);
    visit("fitness", s.fitness);
  }

  /// Whether the sizes of the members agree, and there are at least `min_individuals`.
  bool consistent(Index min_individuals) const {
    return positions.cols() >= min_individuals && positions.rows() == best.size() && fitness.size() == positions.cols();
  }
};

/// A state that lists its members, so that it can be saved; `consistent()` checks that their sizes agree, after they
/// were loaded.
template <class S>
concept ListedState = SearchState<S> && std::default_initializable<S> && requires(S& state, const S& saved) {
  S::each_member(state, [](const char*, auto&) {});
  S::each_member(saved, [](const char*, const auto&) {});
  { saved.consistent() } -> std::same_as<bool>;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/state.ipp"
#endif
