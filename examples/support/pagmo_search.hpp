// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// pagmo2's algorithms as searches of ours.

#include <cmath>
#include <memory>
#include <pagmo/algorithm.hpp>
#include <pagmo/batch_evaluators/member_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

#include "vernier/search/concepts.hpp"

namespace support {

/// Algorithms of pagmo2 that make one generation a call, remember the rest and evaluate a generation as a whole:
/// `PagmoSearch{PagmoSearch::whole_generations(pagmo::pso_gen(1, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true))}`.
struct PagmoSearch {
  pagmo::algorithm algorithm;        ///< one generation a call
  int individuals = 50;              ///< of the population
  vernier::Index generations = 300;  ///< after the first population

  /// What the copies that pagmo makes of a problem share: who evaluates at the moment, and the best so far.
  struct Evaluations {
    vernier::Evaluate evaluate;
    vernier::VectorX best;
    double best_fitness = HUGE_VAL;
  };

  /// An objective as pagmo wants it.
  struct Problem {
    vernier::Box box;
    std::shared_ptr<Evaluations> shared;

    pagmo::vector_double batch_fitness(const pagmo::vector_double& points) const {
      const auto count = static_cast<vernier::Index>(points.size()) / box.dimension();
      const vernier::MatrixX population = Eigen::Map<const vernier::MatrixX>(points.data(), box.dimension(), count);
      vernier::VectorX values;
      shared->evaluate(population, values);
      vernier::Index leader = 0;
      if (const double least = values.minCoeff(&leader); shared->best.size() == 0 || least < shared->best_fitness) {
        shared->best = population.col(leader);
        shared->best_fitness = least;
      }
      return {values.begin(), values.end()};
    }
    pagmo::vector_double fitness(const pagmo::vector_double& x) const { return batch_fitness(x); }
    std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
      return {{box.lower.begin(), box.lower.end()}, {box.upper.begin(), box.upper.end()}};
    }
  };

  /// Between two generations.
  struct State {
    vernier::VectorX best;
    double best_fitness = HUGE_VAL;
    vernier::Index generation = 0;
    pagmo::algorithm algorithm{};
    pagmo::population population{};
  };

  /// An algorithm, set to evaluate a generation as a whole.
  template <class Algorithm>
  static pagmo::algorithm whole_generations(Algorithm algorithm) {
    algorithm.set_bfe(pagmo::bfe(pagmo::member_bfe()));
    return pagmo::algorithm(std::move(algorithm));
  }

  /// The first population, drawn by pagmo.
  State start(const vernier::Box& box, std::uint64_t seed, vernier::Evaluate evaluate) const {
    State s;
    s.algorithm = algorithm;
    s.algorithm.set_seed(static_cast<unsigned>(seed));
    const auto shared = std::make_shared<Evaluations>(Evaluations{evaluate, {}, HUGE_VAL});
    s.population =
        pagmo::population(pagmo::problem(Problem{box, shared}), static_cast<pagmo::population::size_type>(individuals),
                          static_cast<unsigned>(seed));
    take_best(s, *shared);
    return s;
  }

  /// One generation by pagmo.
  void step(State& s, const vernier::Box&, vernier::Evaluate evaluate) const {
    Evaluations& shared = *s.population.get_problem().extract<Problem>()->shared;
    shared = {evaluate, s.best, s.best_fitness};
    s.population = s.algorithm.evolve(s.population);
    take_best(s, shared);
    ++s.generation;
  }

  bool done(const State& s) const { return s.generation >= generations; }

  vernier::Index next_evaluations(const State&) const { return individuals; }

 private:
  static void take_best(State& s, const Evaluations& shared) {
    s.best = shared.best;
    s.best_fitness = shared.best_fitness;
  }
};

}  // namespace support
