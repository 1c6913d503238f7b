// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What a type lacks to be a `Metaheuristic`, in one sentence for each requirement.

#include <concepts>
#include <cstdint>
#include <utility>

#include "vernier/search/concepts.hpp"

namespace vernier::detail {

/// Does not compile for a type that is no `Metaheuristic`: each failed assertion names one requirement. The last one is
/// for requirements that have no sentence.
template <class A>
constexpr bool explain_metaheuristic() {
  if constexpr (!requires { typename A::State; }) {
    static_assert(
        requires { typename A::State; },
        "Metaheuristic: the search needs a type `State`, what one generation hands to the next");
  } else if constexpr (!Metaheuristic<A>) {
    using State = typename A::State;
    static_assert(std::copyable<A>, "Metaheuristic: the search must be copyable");
    static_assert(std::copyable<State>, "Metaheuristic: its `State` must be copyable");
    static_assert(
        requires(const State& state) {
          { state.best } -> std::convertible_to<const VectorX&>;
          { state.best_fitness } -> std::convertible_to<double>;
          { state.generation } -> std::convertible_to<Index>;
        },
        "Metaheuristic: its `State` needs the members `best` (vernier::VectorX), `best_fitness` and `generation`");
    static_assert(
        requires(const A& algorithm, const Box& box, std::uint64_t seed, Evaluate evaluate) {
          { algorithm.start(box, seed, evaluate) } -> std::same_as<State>;
        },
        "Metaheuristic: `start(box, seed, evaluate)` must be const and return `State`");
    static_assert(
        requires(const A& algorithm, State& state, const Box& box, Evaluate evaluate) {
          { algorithm.step(state, box, evaluate) } -> std::same_as<void>;
        },
        "Metaheuristic: `step(state, box, evaluate)` must be const, change the state and return void");
    static_assert(
        requires(const A& algorithm, const State& state) {
          { algorithm.done(state) } -> std::same_as<bool>;
        },
        "Metaheuristic: `done(state)` must be const and return bool");
    static_assert(
        requires(const A& algorithm, const State& state) {
          { algorithm.next_evaluations(state) } -> std::convertible_to<Index>;
        },
        "Metaheuristic: `next_evaluations(state)` must be const and return how many points the next step evaluates");
    static_assert(Metaheuristic<A>, "Metaheuristic: the type does not satisfy the concept");
  }
  return true;
}

}  // namespace vernier::detail
