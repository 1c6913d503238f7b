// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The loop of every metaheuristic: budget, stopping criteria, observer, executor; and resuming.

#include <cstdint>
#include <limits>
#include <utility>

#include "vernier/core/fit_options.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// Stopping criteria beside the algorithm's own schedule.
struct StoppingCriteria {
  /// Generations that would exceed it are not stepped; the first population is always evaluated.
  Index max_evaluations = (std::numeric_limits<Index>::max)();
  Index max_generations = (std::numeric_limits<Index>::max)();  ///< generations after the first population
  double target = -std::numeric_limits<double>::infinity();     ///< objective value that suffices
  Index patience = (std::numeric_limits<Index>::max)();         ///< generations without any improvement

  /// @throws std::invalid_argument naming the value
  VERNIER_API void validate() const;
};

/// Why a search ended.
enum class SearchStatus {
  schedule_ended,    ///< the algorithm's own schedule
  budget_spent,      ///< `max_evaluations` or `max_generations`
  target_reached,    ///< `target`
  stalled,           ///< `patience`
  observer_stopped,  ///< the observer returned false
};

/// Result of a search.
struct SearchResult {
  VectorX best;         ///< best point evaluated
  double best_fitness;  ///< its value; infinity if none was finite
  Index evaluations;    ///< number of objective values computed
  Index generations;    ///< steps after the first population
  /// Why it ended.
  SearchStatus status;
};

/// A search between two generations, with all that is needed to resume it.
template <SearchState S>
struct OngoingSearch {
  S state;                ///< of the algorithm
  Index evaluations = 0;  ///< number of objective values computed
  Index improved_at = 0;  ///< generation of the last improvement
};

namespace detail {

/// An objective of either kind; the other reference is empty.
struct ObjectiveRef {
  FunctionRef<void(const ConstMatrixRef&, VectorRef)> batch;
  FunctionRef<double(const VectorX&)> scalar;

  template <Objective F>
  explicit ObjectiveRef(const F& objective) {
    if constexpr (BatchObjective<F>)
      batch = objective;
    else
      scalar = objective;
  }

  /// Evaluates a population; values that are not finite become +infinity.
  VERNIER_API void evaluate(ExecutorRef executor, const MatrixX& population, VectorX& fitness) const;
};

/// What the loop needs to know between two steps.
struct SearchSnapshot {
  double best_fitness;
  Index generation;
  bool done;
  Index next_evaluations;
};

/// The loop, without the types of algorithm and objective.
VERNIER_API SearchStatus run_search(FunctionRef<SearchSnapshot()> snapshot, FunctionRef<void(Evaluate)> step,
                                    Index& evaluations, Index& improved_at, const ObjectiveRef& objective,
                                    const StoppingCriteria& stop, ExecutorRef executor, ObserverRef observer);

VERNIER_API void check_resumable(Index dimension, const Box& box);

}  // namespace detail

/// The first population of a search, evaluated; `minimize` continues from it.
/// @throws std::invalid_argument on an invalid box or option
template <Metaheuristic A, Objective F>
OngoingSearch<typename A::State> start_search(const A& algorithm, const F& objective, const Box& box,
                                              std::uint64_t seed = 0, ExecutorRef executor = {}) {
  box.validate();
  Index evaluations = 0;
  const detail::ObjectiveRef reference(objective);
  auto state = algorithm.start(box, seed, [&](const MatrixX& population, VectorX& fitness) {
    reference.evaluate(executor, population, fitness);
    evaluations += population.cols();
  });
  return {std::move(state), evaluations, 0};
}

/// Resumes a search, in place: paused anywhere and resumed, it comes to the bits of one that was never paused.
/// `max_evaluations`, `max_generations` and `patience` count from the very beginning of the search.
/// @param algorithm the one it was started with, as objective and box: the caller keeps them
/// @param objective as below
/// @param box       bounds
/// @param search    from `start_search`, from this function or from a file. The observer may save it at every call.
/// After an exception of the objective it must not be resumed.
/// @param stop      budget and stopping criteria
/// @param executor  evaluates the populations
/// @param observer  is called for the generation it resumes from, too
/// @throws std::invalid_argument on an invalid box or option, a search of another dimension, or an algorithm that
/// evaluates more than it announced
template <Metaheuristic A, Objective F>
SearchResult minimize(const A& algorithm, const F& objective, const Box& box, OngoingSearch<typename A::State>& search,
                      const StoppingCriteria& stop = {}, ExecutorRef executor = {}, ObserverRef observer = {}) {
  auto& state = search.state;
  detail::check_resumable(static_cast<const VectorX&>(state.best).size(), box);
  const auto snapshot = [&]() -> detail::SearchSnapshot {
    const bool done = algorithm.done(state);
    return {static_cast<double>(state.best_fitness), static_cast<Index>(state.generation), done,
            done ? Index{0} : static_cast<Index>(algorithm.next_evaluations(state))};
  };
  const auto step = [&](Evaluate evaluate) { algorithm.step(state, box, evaluate); };
  const SearchStatus status = detail::run_search(snapshot, step, search.evaluations, search.improved_at,
                                                 detail::ObjectiveRef(objective), stop, executor, observer);
  return {state.best, state.best_fitness, search.evaluations, static_cast<Index>(state.generation), status};
}

/// Searches a box for the minimum of an objective.
/// @param algorithm any `Metaheuristic`
/// @param objective scalar `double f(x)` or batch `f(population, fitness)`; a value that is not finite counts as the
/// worst
/// @param box       bounds; whether points outside may be evaluated depends on the algorithm
/// @param stop      budget and stopping criteria; by default the algorithm's schedule alone
/// @param seed      same seed, same bits, whatever the executor
/// @param executor  evaluates the populations; a batch objective gets one part per thread. A `DistributedExecutor` may
/// distribute them over processes that all run this same search: they exchange fitness values only.
/// @param observer  called for every generation, with the first population as generation 0; over several processes
/// in the first one only, and its decision holds for all
/// @throws std::invalid_argument on an invalid box or option
template <Metaheuristic A, Objective F>
SearchResult minimize(const A& algorithm, const F& objective, const Box& box, const StoppingCriteria& stop = {},
                      std::uint64_t seed = 0, ExecutorRef executor = {}, ObserverRef observer = {}) {
  stop.validate();
  auto search = start_search(algorithm, objective, box, seed, executor);
  return minimize(algorithm, objective, box, search, stop, executor, observer);
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/minimize.ipp"
#endif
