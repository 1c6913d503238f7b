// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Concepts of population-based searches that minimize an objective over a box, one generation at a time.

#include <concepts>
#include <cstdint>
#include <utility>

#include "vernier/core/box.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Evaluates a population, dimension x particles, into one value per particle. Values that are not finite arrive as
/// +infinity.
using Evaluate = FunctionRef<void(const MatrixX& population, VectorX& fitness)>;

/// What every search state has: the best point evaluated so far, its value, and the number of generations stepped.
template <class S>
concept SearchState = std::copyable<S> && requires(const S& state) {
  { state.best } -> std::convertible_to<const VectorX&>;
  { state.best_fitness } -> std::convertible_to<double>;
  { state.generation } -> std::convertible_to<Index>;
};

/// A population-based search. The state is a value outside the algorithm; one generation is the primitive; `minimize`
/// has the loop.
///
/// - `start(box, seed, evaluate)`: the first population, evaluated
/// - `step(state, box, evaluate)`: one generation, in place; depends on the state alone, so N steps equal a run of N
/// - `done(state)`: whether the algorithm's own schedule has ended
/// - `next_evaluations(state)`: number of points that the next step evaluates, or an upper bound; only where the
///   schedule has not ended. A step that would exceed the budget of evaluations is not made.
///
/// All randomness comes from the seed through the state. `evaluate` is called with whole populations, which may change
/// size; it may throw to end a search, and a step lets the exception pass.
template <class A>
concept Metaheuristic = std::copyable<A> && SearchState<typename A::State> &&
    requires(const A& algorithm, typename A::State& state, const Box& box, std::uint64_t seed, Evaluate evaluate) {
  { algorithm.start(box, seed, evaluate) } -> std::same_as<typename A::State>;
  { algorithm.step(state, box, evaluate) } -> std::same_as<void>;
  { algorithm.done(std::as_const(state)) } -> std::same_as<bool>;
  { algorithm.next_evaluations(std::as_const(state)) } -> std::convertible_to<Index>;
};

/// An objective of whole populations: `f(population, fitness)`, dimension x particles into one value per particle.
/// Columns are independent: it may be called from several threads at once with parts of a population.
template <class F>
concept BatchObjective = requires(const F& f, const ConstMatrixRef& population, VectorRef fitness) {
  f(population, fitness);
};

/// An objective of single points, `double f(x)`; callable from several threads at once.
template <class F>
concept ScalarObjective = requires(const F& f, const VectorX& x) {
  { f(x) } -> std::convertible_to<double>;
};

/// Either kind of objective.
template <class F>
concept Objective = BatchObjective<F> || ScalarObjective<F>;

}  // namespace vernier
