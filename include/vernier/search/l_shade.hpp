// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// L-SHADE: differential evolution with adaptive parameters and linear population size reduction.

#include <algorithm>
#include <cstdint>

#include "vernier/search/state.hpp"

namespace vernier {

/// Success-history based adaptive differential evolution, DE/current-to-pbest/1/bin, with an external archive and
/// linear population size reduction:
///
/// - each trial draws its F from a Cauchy and its CR from a normal distribution centred at one of `memory` remembered
///   pairs; after a generation the oldest pair is replaced by the Lehmer means of the successful F and CR, weighted by
///   the improvements;
/// - the second individual of the difference may come from the archive of replaced individuals;
/// - the population size decreases linearly from `individuals_per_dimension` times the dimension to
///   `final_individuals`, over `max_evaluations`; the last generation makes no more than are left.
///
/// A coordinate that would leave the box is put halfway between the target individual and the bound. An improvement on
/// an infinite value is weighted as the largest finite one of its generation.
/// @cite Tanabe and Fukunaga 2014
struct LShade {
  Index max_evaluations = 15'000;         ///< the schedule, including the first population
  double individuals_per_dimension = 18;  ///< first population, at least `final_individuals`
  int memory = 6;                         ///< number of remembered pairs of F and CR
  double archive_rate = 2.6;              ///< size of the archive relative to the population
  double best_share = 0.11;               ///< p: share of the population that counts as best, at least two

  static constexpr int final_individuals = 4;  ///< of the last population: the fewest that a mutation needs

  /// A population between two generations.
  struct State : PointPopulation {
    MatrixX archive;          ///< dimension x replaced individuals
    VectorX weights;          ///< remembered F
    VectorX crossover_rates;  ///< remembered CR; negative: CR is 0 from then on
    Index oldest = 0;         ///< index of the pair to be replaced next
    Index evaluations = 0;    ///< made so far
    Index first_size = 0;     ///< size of the first population

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      PointPopulation::each_member(s, visit);
      visit("archive", s.archive);
      visit("weights", s.weights);
      visit("crossover_rates", s.crossover_rates);
      visit("oldest", s.oldest);
      visit("evaluations", s.evaluations);
      visit("first_size", s.first_size);
    }

    /// Whether the sizes of the members agree.
    VERNIER_API bool consistent() const;
  };

  /// Individuals uniform in the box.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all evaluations of the schedule were made.
  bool done(const State& s) const { return s.evaluations >= max_evaluations; }

  /// One trial per individual, in the last generation as many as are left.
  Index next_evaluations(const State& s) const {
    return (std::min)(s.positions.cols(), max_evaluations - s.evaluations);
  }

  /// Population size after a number of evaluations.
  VERNIER_API Index individuals(Index first_size, Index evaluations) const;

  /// Replaces the oldest pair by the weighted Lehmer means of the F and CR whose trials improved on their targets;
  /// nothing changes where none did.
  /// @param s      the population before its targets are replaced
  /// @param values of the trials
  /// @param f      F of the trials
  /// @param cr     CR of the trials
  VERNIER_API static void remember(State& s, const VectorX& values, const VectorX& f, const VectorX& cr);

  /// Replaces targets by trials that are not worse. A target that was worse than its trial goes to the archive, at a
  /// random place once that is full.
  VERNIER_API void replace(State& s, const MatrixX& trials, const VectorX& values) const;

  /// Removes the worst individuals above the scheduled size, and from the archive random ones above its own.
  VERNIER_API void shrink(State& s) const;

 private:
  VERNIER_API Index archive_size(Index individuals) const;
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/l_shade.ipp"
#endif
