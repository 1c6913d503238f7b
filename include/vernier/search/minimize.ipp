// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/minimize.hpp"

#include <algorithm>
#include <cmath>

namespace vernier {

VERNIER_IMPL void StoppingCriteria::validate() const {
  demand(max_evaluations >= 1, "minimize: max_evaluations is ", max_evaluations, ", must be at least 1");
  demand(patience >= 1, "minimize: patience is ", patience, ", must be at least 1");
}

namespace detail {

VERNIER_IMPL void ObjectiveRef::evaluate(ExecutorRef executor, const MatrixX& population, VectorX& fitness) const {
  fitness.resize(population.cols());
  // The fingerprint of the search, by which an executor detects processes that run different ones.
  if (executor.is_distributed()) fitness = VERNIER_LATER(population).row(0).transpose();
  executor.allgather(fitness, [&](Index begin, Index end) {
    if (batch)
      return batch(VERNIER_LATER(population).middleCols(begin, end - begin),
                   VERNIER_LATER(fitness).segment(begin, end - begin));
    VectorX x(population.rows());
    for (Index k = begin; k < end; ++k) {
      std::copy_n(VERNIER_LATER(population).col(k).data(), x.size(), x.data());
      fitness(k) = scalar(x);
    }
  });
  for (auto& value : fitness)
    if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
}

VERNIER_IMPL SearchStatus run_search(FunctionRef<SearchSnapshot()> snapshot, FunctionRef<void(Evaluate)> step,
                                     Index& evaluations, Index& improved_at, const ObjectiveRef& objective,
                                     const StoppingCriteria& stop, ExecutorRef executor, ObserverRef observer) {
  stop.validate();
  for (;;) {
    const SearchSnapshot now = snapshot();
    const Progress progress{now.generation, evaluations, now.best_fitness};
    if (!executor.broadcast([&] { return observer(progress); })) return SearchStatus::observer_stopped;
    if (now.best_fitness <= stop.target) return SearchStatus::target_reached;
    if (now.done) return SearchStatus::schedule_ended;
    if (now.generation >= stop.max_generations || evaluations >= stop.max_evaluations)
      return SearchStatus::budget_spent;
    if (now.generation - improved_at >= stop.patience) return SearchStatus::stalled;
    if (now.next_evaluations > stop.max_evaluations - evaluations) return SearchStatus::budget_spent;
    Index announced = now.next_evaluations;
    step([&](const MatrixX& population, VectorX& fitness) {
      demand(population.cols() <= announced, "minimize: a step evaluates more points than the ", now.next_evaluations,
             " that next_evaluations announced");
      announced -= population.cols();
      objective.evaluate(executor, population, fitness);
      evaluations += population.cols();
    });
    const SearchSnapshot after = snapshot();
    if (after.best_fitness < now.best_fitness) improved_at = after.generation;
  }
}

VERNIER_IMPL void check_resumable(Index dimension, const Box& box) {
  box.validate();
  demand(dimension == box.dimension(), "minimize: the best point of the search has ", dimension,
         dimension == 1 ? " entry" : " entries", ", the box ", box.dimension());
}

}  // namespace detail

}  // namespace vernier
