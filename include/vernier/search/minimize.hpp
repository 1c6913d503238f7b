#pragma once

/// @file
/// The one loop around every metaheuristic: budget, stopping, observers, executor.

#include <cmath>
#include <limits>

#include "vernier/core/fit_options.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// When a search ends before its algorithm's own schedule.
struct Stop {
  /// A generation that might pass it, were it as large as the last, is not started; the first population always is.
  Index max_evaluations = std::numeric_limits<Index>::max();
  Index max_generations = std::numeric_limits<Index>::max();  ///< generations after the first population
  double target = -std::numeric_limits<double>::infinity();   ///< enough is enough
  Index patience = std::numeric_limits<Index>::max();         ///< generations without any improvement
};

/// Why a search ended.
enum class SearchStatus {
  schedule_ended,    ///< the algorithm's own number of generations
  budget_spent,      ///< `max_evaluations` or `max_generations`
  target_reached,    ///< `target`
  stalled,           ///< `patience`
  observer_stopped,  ///< an observer asked for it
};

/// What a search found.
struct SearchResult {
  VectorX best;         ///< best point evaluated
  double best_fitness;  ///< its value; infinity if none was finite
  Index evaluations;    ///< objective values computed
  Index generations;    ///< steps after the first population
  /// How it ended.
  SearchStatus status;
};

/// Searches a box for the least value of an objective.
/// @param algorithm any `Metaheuristic`
/// @param objective scalar `double f(x)` or batch `f(population, fitness)`; a value that is not finite counts as the
/// worst
/// @param box       bounds; what an algorithm does with them it says itself
/// @param stop      budget and stopping; by default the algorithm's schedule alone
/// @param seed      same seed, same bits, whatever the executor
/// @param executor  who evaluates a population; a batch objective gets one part a thread. A `GatheringExecutor` may
/// share it out over processes that all run this same search: fitness is all they have to exchange.
/// @param observer  sees every generation, the first population as generation 0; over several processes the first one's
/// is asked, for all of them
/// @throws std::invalid_argument on an unusable box or option
template <Metaheuristic A, Objective F>
SearchResult minimize(const A& algorithm, const F& objective, const Box& box, const Stop& stop = {},
                      std::uint64_t seed = 0, ExecutorRef executor = {}, ObserverRef observer = {}) {
  box.validate();
  require(stop.max_evaluations >= 1, "minimize: max_evaluations is ", stop.max_evaluations, ", must be at least 1");
  require(stop.patience >= 1, "minimize: patience is ", stop.patience, ", must be at least 1");
  Index evaluations = 0, last_size = 0;
  const auto counted = [&](const MatrixX& population, VectorX& fitness) {
    fitness.resize(population.cols());
    if (executor.gathers()) fitness = population.row(0).transpose();  // by which processes know each other's search
    executor.fill(fitness, [&](Index begin, Index end) {
      if constexpr (BatchObjective<F>) {
        objective(population.middleCols(begin, end - begin), fitness.segment(begin, end - begin));
      } else {
        VectorX x(population.rows());
        for (Index k = begin; k < end; ++k) {
          x = population.col(k);
          fitness(k) = objective(x);
        }
      }
    });
    for (auto& value : fitness)
      if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
    last_size = population.cols();
    evaluations += last_size;
  };

  typename A::State state = algorithm.start(box, seed, counted);
  Index improved_at = 0;
  for (;;) {
    const auto result = [&](SearchStatus status) {
      return SearchResult{state.best, state.best_fitness, evaluations, state.generation, status};
    };
    if (!executor.decide([&] { return observer(Progress{state.generation, evaluations, state.best_fitness}); }))
      return result(SearchStatus::observer_stopped);
    if (state.best_fitness <= stop.target) return result(SearchStatus::target_reached);
    if (algorithm.done(state)) return result(SearchStatus::schedule_ended);
    if (state.generation >= stop.max_generations || stop.max_evaluations - evaluations < last_size)
      return result(SearchStatus::budget_spent);
    if (state.generation - improved_at >= stop.patience) return result(SearchStatus::stalled);
    const double before = state.best_fitness;
    algorithm.step(state, box, counted);
    if (state.best_fitness < before) improved_at = state.generation;
  }
}

}  // namespace vernier
