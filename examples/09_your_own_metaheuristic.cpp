// SPDX-License-Identifier: BSD-3-Clause
// Your own search: a recipe with start(), step(), done() and next_evaluations() on a state kept outside. Tuned accepts
// it like Pso.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/elm.hpp>
#include <vernier/search/pso.hpp>
#include <vernier/search/tuned.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>
#include <vernier/testing/metaheuristic_laws.hpp>

namespace vn = vernier;

// The (1 + lambda) evolution strategy: the best of a parent and its children is the next parent. Steps grow when a
// generation improved and shrink when it did not.
struct EvolutionStrategy {
  int children = 20;
  vn::Index generations = 60;

  struct State {
    vn::VectorX best;                // the parent
    double best_fitness = HUGE_VAL;  // nothing evaluated yet
    vn::Index generation = 0;
    double step = 0.15;  // standard deviation, relative to the width of the box
    vn::Rng rng;         // all randomness lives here: the same seed gives the same bits
  };

  State start(const vn::Box& box, std::uint64_t seed, vn::Evaluate evaluate) const {
    State s;
    s.rng = vn::Rng(seed);
    s.best = (box.lower + box.upper) / 2;
    breed(s, box, evaluate);
    return s;
  }
  void step(State& s, const vn::Box& box, vn::Evaluate evaluate) const {
    s.step *= breed(s, box, evaluate) ? 1.3 : 0.85;
    ++s.generation;
  }
  bool done(const State& s) const { return s.generation >= generations; }
  vn::Index next_evaluations(const State&) const { return children; }  // of the next step, for budgets of evaluations

 private:
  // Children around the parent, one a column, kept in the box; true when the best of them replaced it.
  bool breed(State& s, const vn::Box& box, vn::Evaluate evaluate) const {
    vn::MatrixX population(box.dimension(), children);
    for (vn::Index k = 0; k < children; ++k)
      for (vn::Index d = 0; d < box.dimension(); ++d)
        population(d, k) =
            std::clamp(s.best(d) + s.step * (box.upper(d) - box.lower(d)) * s.rng.normal(), box.lower(d), box.upper(d));
    vn::VectorX fitness;
    evaluate(population, fitness);  // a whole population at once, so that threads can share it
    vn::Index leader = 0;
    if (!(fitness.minCoeff(&leader) < s.best_fitness)) return false;
    s.best_fitness = fitness(leader);
    s.best = population.col(leader);
    return true;
  }
};
static_assert(vn::Metaheuristic<EvolutionStrategy>);

int main() {
  // The laws: the same seed gives the same bits, N steps equal a run of N, threads change nothing, the box is kept.
  const auto violations = vn::testing::metaheuristic_violations(EvolutionStrategy{}, /*keeps_box=*/true);
  for (const auto& violation : violations) std::printf("broken law: %s\n", violation.c_str());
  if (!violations.empty()) return 1;
  std::printf("the evolution strategy obeys the laws of metaheuristics\n");

  // In an ELM, with no other change.
  const auto nominal = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);
  const auto region = vn::abb_irb120_operating_region();
  const auto train = vn::measure(actual, region.sample(nominal, 300, 1));
  const auto test = vn::measure(actual, region.sample(nominal, 300, 2));
  const vn::Elm elm{.hidden_nodes = 25};
  const auto report = [&](const char* name, const auto& regressor) {
    const auto fitted = vn::CartesianCompensation{regressor}.fit(nominal, train, {.seed = 1});
    std::printf("  %-8s %.3f mm\n", name, vn::prediction_error(fitted, test).mean * 1e3);
  };
  std::printf("mean error on 300 fresh poses, 1220 evaluations each:\n");
  report("ELM", elm);
  report("ES-ELM", vn::Tuned{elm, EvolutionStrategy{}});
  report("PSO-ELM", vn::Tuned{elm, vn::Pso{.particles = 20, .iterations = 60}});
}
