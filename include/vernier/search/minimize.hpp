#pragma once

/// @file
/// The one loop around every metaheuristic: budget, stopping, observers, executor; and going on where one stopped.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vernier/core/fit_options.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// When a search ends before its algorithm's own schedule.
struct Stop {
  /// A generation that would pass it is not evaluated; the first population always is.
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

/// A search between two generations, and all it takes to go on with it.
template <SearchState S>
struct OngoingSearch {
  S state;                ///< of the algorithm
  Index evaluations = 0;  ///< objective values computed
  Index improved_at = 0;  ///< generation of the last improvement
};

namespace detail {

/// Ends a step that would pass the budget.
struct BudgetSpent {};

/// An objective, evaluated by an executor and counted.
template <Objective F>
class CountedObjective {
 public:
  CountedObjective(const F& objective, ExecutorRef executor, Index& evaluations, Index limit)
      : objective_(objective), executor_(executor), evaluations_(evaluations), limit_(limit) {}

  void operator()(const MatrixX& population, VectorX& fitness) const {
    if (population.cols() > limit_ - evaluations_) throw BudgetSpent{};
    fitness.resize(population.cols());
    if (executor_.gathers()) fitness = population.row(0).transpose();  // by which processes know each other's search
    executor_.fill(fitness, [&](Index begin, Index end) {
      if constexpr (BatchObjective<F>) {
        objective_(population.middleCols(begin, end - begin), fitness.segment(begin, end - begin));
      } else {
        VectorX x(population.rows());
        for (Index k = begin; k < end; ++k) {
          std::copy_n(population.col(k).data(), x.size(), x.data());
          fitness(k) = objective_(x);
        }
      }
    });
    for (auto& value : fitness)
      if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
    evaluations_ += population.cols();
  }

 private:
  const F& objective_;
  ExecutorRef executor_;
  Index& evaluations_;
  Index limit_;
};

}  // namespace detail

/// The first population of a search, evaluated, to go on with.
/// @throws std::invalid_argument on an unusable box or option
template <Metaheuristic A, Objective F>
OngoingSearch<typename A::State> start_search(const A& algorithm, const F& objective, const Box& box,
                                              std::uint64_t seed = 0, ExecutorRef executor = {}) {
  box.validate();
  Index evaluations = 0;
  const detail::CountedObjective<F> counted(objective, executor, evaluations, std::numeric_limits<Index>::max());
  auto state = algorithm.start(box, seed, counted);
  return {std::move(state), evaluations, 0};
}

/// Goes on with a search, in place: stopped anywhere and gone on with, it comes to the bits of one that was never
/// stopped. `max_evaluations`, `max_generations` and `patience` count from the search's very beginning.
/// @param algorithm the one it was started with, as are objective and box: they are for the caller to keep
/// @param objective as below
/// @param box       bounds
/// @param search    from `start_search`, from this function or from a file. An observer may save it whenever it is
/// called. After an exception of the objective it is lost.
/// @param stop      budget and stopping
/// @param executor  who evaluates a population
/// @param observer  sees the generation it goes on from, too
/// @throws std::invalid_argument on an unusable box or option, or a search of another dimension
template <Metaheuristic A, Objective F>
SearchResult minimize(const A& algorithm, const F& objective, const Box& box, OngoingSearch<typename A::State>& search,
                      const Stop& stop = {}, ExecutorRef executor = {}, ObserverRef observer = {}) {
  box.validate();
  require(stop.max_evaluations >= 1, "minimize: max_evaluations is ", stop.max_evaluations, ", must be at least 1");
  require(stop.patience >= 1, "minimize: patience is ", stop.patience, ", must be at least 1");
  require(search.state.best.size() == box.dimension(), "minimize: a search in ", search.state.best.size(),
          " dimensions cannot go on in a box of ", box.dimension());
  auto& [state, evaluations, improved_at] = search;
  const detail::CountedObjective<F> counted(objective, executor, search.evaluations, stop.max_evaluations);
  const bool limited = stop.max_evaluations != std::numeric_limits<Index>::max();
  typename A::State before = state;
  for (;;) {
    const auto result = [&search](SearchStatus status) {
      return SearchResult{search.state.best, search.state.best_fitness, search.evaluations, search.state.generation,
                          status};
    };
    const Progress progress{state.generation, evaluations, state.best_fitness};
    if (!executor.decide([&] { return observer(progress); })) return result(SearchStatus::observer_stopped);
    if (state.best_fitness <= stop.target) return result(SearchStatus::target_reached);
    if (algorithm.done(state)) return result(SearchStatus::schedule_ended);
    if (state.generation >= stop.max_generations || evaluations >= stop.max_evaluations)
      return result(SearchStatus::budget_spent);
    if (state.generation - improved_at >= stop.patience) return result(SearchStatus::stalled);
    // How large a population will be only the step knows: one that would pass the budget is undone.
    if (limited) before = state;
    const double best = state.best_fitness;
    try {
      algorithm.step(state, box, counted);
    } catch (const detail::BudgetSpent&) {
      state = std::move(before);
      return result(SearchStatus::budget_spent);
    }
    if (state.best_fitness < best) improved_at = state.generation;
  }
}

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
  require(stop.max_evaluations >= 1, "minimize: max_evaluations is ", stop.max_evaluations, ", must be at least 1");
  require(stop.patience >= 1, "minimize: patience is ", stop.patience, ", must be at least 1");
  auto search = start_search(algorithm, objective, box, seed, executor);
  return minimize(algorithm, objective, box, search, stop, executor, observer);
}

}  // namespace vernier
