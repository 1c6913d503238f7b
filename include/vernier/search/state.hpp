#pragma once

/// @file
/// What the states of all searches have in common.

#include <concepts>
#include <cstdint>
#include <limits>

#include "vernier/core/rng.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// The part of a state that every search of ours has. States derive from it and list all their members with
/// `each_member(state, visit)`, `visit(name, member)`: what is saved and loaded.
struct CommonState {
  VectorX best;  ///< best point evaluated
  /// Its value.
  double best_fitness = std::numeric_limits<double>::infinity();
  /// Generations stepped.
  Index generation = 0;
  /// Source of all randomness.
  Rng rng{};

  /// Remembers the best of a population that was just evaluated, where it is better than what was known; the very first
  /// always is.
  void keep_best(const MatrixX& population, const VectorX& fitness) {
    Index leader = 0;
    const double value = fitness.minCoeff(&leader);
    if (!(value < best_fitness) && best.size() > 0) return;
    best_fitness = value;
    best = population.col(leader);
  }

  /// Lists the members.
  template <class Self, class Visit>
  static void each_member(Self& s, Visit&& visit) {
    visit("best", s.best);
    visit("best_fitness", s.best_fitness);
    visit("generation", s.generation);
    visit("rng", s.rng);
  }
};

/// Points drawn uniformly from a box, one a column, coordinate by coordinate.
inline MatrixX uniform_points(const Box& box, Index count, Rng& rng) {
  MatrixX points(box.dimension(), count);
  for (Index k = 0; k < count; ++k)
    for (Index d = 0; d < points.rows(); ++d) points(d, k) = rng.uniform(box.lower(d), box.upper(d));
  return points;
}

/// A population of points between two generations.
struct PointPopulation : CommonState {
  MatrixX positions;  ///< dimension x individuals
  VectorX fitness;    ///< one value an individual

  /// So many individuals uniform in the box, evaluated.
  void draw(const Box& box, Index individuals, std::uint64_t seed, Evaluate evaluate) {
    rng = Rng(seed);
    positions = uniform_points(box, individuals, rng);
    evaluate(positions, fitness);
    keep_best(positions, fitness);
  }

  /// Lists the members.
  template <class Self, class Visit>
  static void each_member(Self& s, Visit&& visit) {
    CommonState::each_member(s, visit);
    visit("positions", s.positions);
    visit("fitness", s.fitness);
  }

  /// Whether the sizes of the members agree, and there are as many individuals as an algorithm needs.
  bool consistent(Index least) const {
    return positions.cols() >= least && positions.rows() == best.size() && fitness.size() == positions.cols();
  }
};

/// A state whose members can be listed, so that it can be saved; `consistent()` says whether their sizes agree, which
/// is what a file is asked.
template <class S>
concept ListedState = SearchState<S> && std::default_initializable<S> && requires(S& state, const S& saved) {
  S::each_member(state, [](const char*, auto&) {});
  S::each_member(saved, [](const char*, const auto&) {});
  { saved.consistent() } -> std::same_as<bool>;
};

}  // namespace vernier
