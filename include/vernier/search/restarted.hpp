// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Restarts of a search whose schedule has ended.

#include <cstdint>

#include "vernier/search/detail/explain_search.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// An algorithm that is restarted, each time from a seed of its own (`child_seed`), when its schedule ends; the best of
/// all runs counts. A start is a generation, and all starts evaluate the same number of points.
/// `const Restarted search{CmaEs{}, 9};`
/// @tparam A a `Metaheuristic`
template <class A>
struct Restarted {
  static_assert(detail::explain_metaheuristic<A>());

  /// The algorithm restarted.
  A algorithm;
  Index restarts = 9;  ///< after the first run

  /// Between two generations.
  struct State {
    typename A::State current;  ///< of the current run
    VectorX best;               ///< best point of all runs
    double best_fitness = 0;    ///< its value
    Index generation = 0;       ///< generations stepped, starts included
    Index run = 0;              ///< number of runs before this one
    Index start_size = 0;       ///< number of points a start evaluates
    std::uint64_t seed = 0;     ///< of the whole search

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      visit("current", s.current);
      visit("best", s.best);
      visit("best_fitness", s.best_fitness);
      visit("generation", s.generation);
      visit("run", s.run);
      visit("start_size", s.start_size);
      visit("seed", s.seed);
    }

    /// Whether the sizes of the members agree.
    bool consistent() const { return current.consistent() && current.best.size() == best.size(); }
  };

  /// The first run's start.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    demand(restarts >= 0, "Restarted: restarts is ", restarts, ", must not be negative");
    Index evaluations = 0;
    const auto counted = [&](const MatrixX& population, VectorX& fitness) {
      evaluations += population.cols();
      evaluate(population, fitness);
    };
    State s{.current = algorithm.start(box, child_seed(seed, 0), counted), .best = {}, .seed = seed};
    s.start_size = evaluations;
    s.best = s.current.best;
    s.best_fitness = s.current.best_fitness;
    return s;
  }

  /// A generation of the current run, or the next start.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    if (algorithm.done(s.current)) {
      s.current = algorithm.start(box, child_seed(s.seed, static_cast<std::uint64_t>(s.run + 1)), evaluate);
      ++s.run;
    } else {
      algorithm.step(s.current, box, evaluate);
    }
    if (s.current.best_fitness < s.best_fitness) {
      s.best = s.current.best;
      s.best_fitness = s.current.best_fitness;
    }
    ++s.generation;
  }

  /// Whether the last run's schedule has ended.
  bool done(const State& s) const { return s.run >= restarts && algorithm.done(s.current); }

  /// Those of the current run, or of a start.
  Index next_evaluations(const State& s) const {
    return algorithm.done(s.current) ? s.start_size : static_cast<Index>(algorithm.next_evaluations(s.current));
  }
};

/// Deduction guide, for compilers that have none for aggregates.
template <class A>
Restarted(A) -> Restarted<A>;
/// Deduction guide, for compilers that have none for aggregates.
template <class A>
Restarted(A, Index) -> Restarted<A>;

}  // namespace vernier
