// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The laws of `Metaheuristic`, checked at run time: a list of violations.

#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "vernier/core/same_value.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/testing/detail/search_record.hpp"

namespace vernier::testing {

namespace detail {

/// Checks one algorithm on objectives of its own.
template <Metaheuristic A>
class MetaheuristicCheck {
 public:
  MetaheuristicCheck(const A& algorithm, bool keeps_box) : algorithm_(algorithm), keeps_box_(keeps_box) {}

  std::vector<std::string> run() {
    try {
      repeatability();
      best_point();
      if (!announcements()) return std::move(violations_);  // minimize would throw
      through_minimize();
      budgets();
      resuming();
      values_not_finite();
    } catch (const std::exception& error) {
      violations_.push_back(message("metaheuristic: threw on a valid problem: ", error.what()));
    }
    return std::move(violations_);
  }

 private:
  using State = typename A::State;
  static constexpr Index generations = 12;

  void expect(bool holds, const char* law) {
    if (!holds) violations_.push_back(message("metaheuristic: ", law));
  }

  /// A search of `generations` steps, or what the algorithm's schedule allows.
  State search(std::uint64_t seed, SearchRecord& record) const {
    const auto evaluate = bowl_.recorder(record);
    State state = algorithm_.start(bowl_.box, seed, evaluate);
    while (state.generation < generations && !algorithm_.done(state)) {
      const Index before = state.generation;
      algorithm_.step(state, bowl_.box, evaluate);
      if (state.generation != before + 1) throw std::runtime_error("step does not count its generation");
    }
    return state;
  }

  void repeatability() {
    SearchRecord first, again, other, left, right;
    const State alone = search(1, first);
    const State repeated = search(1, again);
    expect(first == again && same_bits(alone.best, repeated.best), "the same seed made another search");
    search(2, other);
    expect(!(first == other), "another seed made the same search");

    // Two searches of one algorithm, stepped alternately.
    const auto record_left = bowl_.recorder(left), record_right = bowl_.recorder(right);
    State a = algorithm_.start(bowl_.box, 1, record_left), b = algorithm_.start(bowl_.box, 2, record_right);
    expect(a.generation == 0, "the first population is not generation 0");
    while (a.generation < generations && !algorithm_.done(a)) {
      algorithm_.step(a, bowl_.box, record_left);
      algorithm_.step(b, bowl_.box, record_right);
    }
    expect(left == first && right == other,
           "searches stepped alternately disturb each other: the algorithm hides state");

    // A copied state continues as the original, also with a copy of the algorithm.
    SearchRecord of_original, of_copy;
    const A same_algorithm = algorithm_;
    State original = algorithm_.start(bowl_.box, 3, bowl_.recorder(of_original));
    if (algorithm_.done(original)) return;
    algorithm_.step(original, bowl_.box, bowl_.recorder(of_original));
    State copy = original;
    of_original = {};
    for (int i = 0; i < 3 && !algorithm_.done(original); ++i)
      algorithm_.step(original, bowl_.box, bowl_.recorder(of_original));
    for (int i = 0; i < 3 && !same_algorithm.done(copy); ++i)
      same_algorithm.step(copy, bowl_.box, bowl_.recorder(of_copy));
    expect(of_original == of_copy && same_bits(original.best, copy.best),
           "a copied state continued differently from the original");
  }

  /// Whether the state's best is the best point evaluated so far, with its value.
  bool best_was_evaluated(const State& state, const SearchRecord& record) const {
    bool found = false;
    for (std::size_t i = 0; i < record.populations.size(); ++i)
      for (Index k = 0; k < record.values[i].size(); ++k) {
        if (record.values[i](k) < state.best_fitness) return false;
        found =
            found || (record.values[i](k) == state.best_fitness && same_bits(record.populations[i].col(k), state.best));
      }
    return found;
  }

  void best_point() {
    SearchRecord record;
    const auto evaluate = bowl_.recorder(record);
    State state = algorithm_.start(bowl_.box, 4, evaluate);
    bool monotone = true, evaluated = best_was_evaluated(state, record);
    while (state.generation < generations && !algorithm_.done(state)) {
      const double before = state.best_fitness;
      algorithm_.step(state, bowl_.box, evaluate);
      monotone = monotone && state.best_fitness <= before;
      evaluated = evaluated && best_was_evaluated(state, record);
    }
    expect(monotone, "the best value became worse");
    expect(evaluated, "best is not the best point evaluated, with its value");

    bool dimensions = true, inside = true;
    for (const MatrixX& population : record.populations) {
      dimensions = dimensions && population.rows() == bowl_.box.dimension();
      for (Index k = 0; dimensions && k < population.cols(); ++k)
        inside = inside && bowl_.box.contains(population.col(k));
    }
    expect(dimensions, "a population has the wrong dimension");
    if (keeps_box_) expect(inside, "a point outside the box was evaluated");
  }

  void through_minimize() {
    SearchRecord record;
    const State stepped = search(5, record);
    Index evaluations = 0;
    for (const VectorX& values : record.values) evaluations += values.size();
    std::atomic<Index> calls = 0;
    const auto objective = [&](const VectorX& x) {
      ++calls;
      return bowl_(x);
    };
    const auto batch = [this](const Eigen::Ref<const MatrixX>& population, Eigen::Ref<VectorX> fitness) {
      for (Index k = 0; k < population.cols(); ++k) fitness(k) = bowl_(population.col(k));
    };
    const auto equal = [&](const SearchResult& result) {
      return same_bits(result.best, stepped.best) && result.best_fitness == stepped.best_fitness &&
             result.generations == stepped.generation && result.evaluations == evaluations;
    };
    const StoppingCriteria stop{.max_generations = generations};
    const SearchResult result = minimize(algorithm_, objective, bowl_.box, stop, 5);
    expect(equal(result), "N steps differ from a run of N through minimize");
    expect(result.evaluations == calls, "minimize counts another number of evaluations than were made");
    for (const int threads : {1, 2}) {
      const ThreadExecutor executor(threads);
      expect(equal(minimize(algorithm_, objective, bowl_.box, stop, 5, executor)) &&
                 equal(minimize(algorithm_, batch, bowl_.box, stop, 5, executor)),
             threads == 1 ? "another result with an executor of 1 thread" : "another result with 2 threads");
    }
  }

  /// No step evaluates more than announced.
  bool announcements() {
    Index made = 0;
    const auto counting = [&](const MatrixX& population, VectorX& fitness) {
      SearchRecord ignored;
      bowl_.recorder(ignored)(population, fitness);
      made += population.cols();
    };
    State state = algorithm_.start(bowl_.box, 5, counting);
    spent_ = {made};
    bool honest = true;
    while (state.generation < generations && !algorithm_.done(state)) {
      announced_.push_back(made + static_cast<Index>(algorithm_.next_evaluations(state)));
      algorithm_.step(state, bowl_.box, counting);
      honest = honest && made <= announced_.back();
      spent_.push_back(made);
    }
    expect(honest, "a step evaluated more points than next_evaluations announced");
    return honest;
  }

  /// Every budget ends the search before the generation that would exceed it.
  void budgets() {
    bool kept = true, exhausted = true;
    for (const Index at : spent_)
      for (const Index budget : {at - 1, at, at + 1}) {
        if (budget < spent_.front()) continue;
        std::atomic<Index> calls = 0;
        const auto objective = [&](const VectorX& x) {
          ++calls;
          return bowl_(x);
        };
        const SearchResult limited =
            minimize(algorithm_, objective, bowl_.box,
                     StoppingCriteria{.max_evaluations = budget, .max_generations = generations}, 5);
        kept = kept && limited.evaluations <= budget && calls == limited.evaluations;
        Index affordable = 0;
        for (const Index needed : announced_) {
          if (needed > budget) break;
          ++affordable;
        }
        exhausted = exhausted && limited.generations == affordable;
      }
    expect(kept, "the budget of evaluations was exceeded");
    expect(exhausted, "another number of generations than the budget of evaluations allows");
  }

  /// A search that is paused and resumed, also before a generation that exceeds the budget, is one that never paused.
  void resuming() {
    std::vector<Index> spent;
    const auto watch = [&](const Progress& progress) { spent.push_back(progress.evaluations); };
    const StoppingCriteria last{.max_generations = generations};
    const SearchResult right = minimize(algorithm_, bowl_, bowl_.box, last, 6, {}, watch);
    for (std::size_t g = 0; g + 1 < spent.size(); ++g)
      for (const StoppingCriteria& pause :
           {StoppingCriteria{.max_generations = static_cast<Index>(g)},
            StoppingCriteria{.max_evaluations = spent[g] + 1, .max_generations = generations}}) {
        auto search = start_search(algorithm_, bowl_, bowl_.box, 6);
        minimize(algorithm_, bowl_, bowl_.box, search, pause);
        auto copy = search;
        const SearchResult found = minimize(algorithm_, bowl_, bowl_.box, copy, last);
        if (same_bits(found.best, right.best) && same_value(found.best_fitness, right.best_fitness) &&
            found.evaluations == right.evaluations && found.generations == right.generations)
          continue;
        return expect(false, "a search that was paused and resumed came to another result");
      }
  }

  /// Values that are not finite arrive as +infinity, which is never the best once a finite value was evaluated.
  void values_not_finite() {
    bool finite_seen = false;
    const auto objective = [&](const VectorX& x) {
      const double at = (x(0) - bowl_.box.lower(0)) / (bowl_.box.upper(0) - bowl_.box.lower(0));
      if (at < 0.3) return std::numeric_limits<double>::quiet_NaN();
      if (at < 0.4) return -std::numeric_limits<double>::infinity();
      if (at < 0.5) return std::numeric_limits<double>::infinity();
      finite_seen = true;
      return bowl_(x);
    };
    // A small population may lie in that half altogether, but not in every one of eight searches.
    bool sound = true, found = false;
    for (std::uint64_t seed = 10; seed < 18; ++seed) {
      finite_seen = false;
      const SearchResult result =
          minimize(algorithm_, objective, bowl_.box, StoppingCriteria{.max_generations = generations}, seed);
      found = found || finite_seen;
      sound = sound && (finite_seen ? same_value(objective(result.best), result.best_fitness)
                                    : same_value(result.best_fitness, std::numeric_limits<double>::infinity()));
    }
    expect(sound, "a value that is not finite became the best");
    expect(found, "with values that are not finite in half of the box the other half was never found");
    const auto never = [](const VectorX&) { return std::numeric_limits<double>::quiet_NaN(); };
    const SearchResult none =
        minimize(algorithm_, never, bowl_.box, StoppingCriteria{.max_generations = generations}, 1);
    expect(same_value(none.best_fitness, std::numeric_limits<double>::infinity()) &&
               none.best.size() == bowl_.box.dimension() && none.best.allFinite(),
           "where no value is finite the best is not a point with the value infinity");
  }

  const A& algorithm_;
  bool keeps_box_;
  Bowl bowl_;
  std::vector<Index> spent_, announced_;  // evaluations after each generation, and at most after its next one
  std::vector<std::string> violations_;
};

}  // namespace detail

/// Checks the laws of `Metaheuristic` on a quadratic function whose minimum lies outside the box:
///
/// - the same seed gives the same bits, another seed another search, also when two searches are stepped alternately;
/// - a copied state continues as the original; N steps equal a run of N through `minimize`;
/// - the best value never becomes worse, and best is the best of the points evaluated;
/// - nothing outside the box is evaluated, where `keeps_box`;
/// - 1 and 2 threads give the same bits, and `minimize` counts the evaluations made;
/// - no step evaluates more points than announced, and no budget of evaluations is exceeded;
/// - a search that is paused and resumed comes to the same bits;
/// - a value that is not finite is never the best.
/// @param algorithm its schedule should have at least a few generations
/// @param keeps_box whether nothing outside the box may be evaluated
/// @return one sentence per violation; empty when all laws hold
template <Metaheuristic A>
std::vector<std::string> metaheuristic_violations(const A& algorithm, bool keeps_box) {
  return detail::MetaheuristicCheck<A>(algorithm, keeps_box).run();
}

}  // namespace vernier::testing
