// SPDX-License-Identifier: BSD-3-Clause
// Every algorithm through the laws of its concept, and the laws against planted faults.

#include "vernier/testing/metaheuristic_laws.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "complaint.hpp"
#include "laws.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/restarted.hpp"
#include "vernier/search/spso2011.hpp"

namespace vernier::metaheuristic_laws_test {
namespace {

using testing::metaheuristic_violations;
using namespace vernier_test;

template <class Algorithm>
void expect_laws(const Algorithm& algorithm, bool keeps_box = true) {
  EXPECT_TRUE(no_violations(metaheuristic_violations(algorithm, keeps_box)));
}

TEST(MetaheuristicLaws, Pso) {
  using vernier::Pso;
  expect_laws(Pso{.particles = 10, .iterations = 20}, false);
  expect_laws(Pso{.particles = 10, .iterations = 20, .positions = PositionRule::clamped});
  expect_laws(Pso{.particles = 10, .iterations = 20, .velocity_limit = 9, .positions = PositionRule::reflected});
  for (const Neighbourhood neighbourhood : {Neighbourhood::ring, Neighbourhood::von_neumann})
    for (const int particles : {1, 2, 7, 12}) {
      SCOPED_TRACE(particles);
      Pso pso = Pso::constriction();
      pso.iterations = 20;
      pso.neighbourhood = neighbourhood;
      pso.particles = particles;
      expect_laws(pso);
    }
  expect_laws(Pso{.particles = 1, .iterations = 5}, false);
  expect_laws(Pso{.particles = 3, .iterations = 0});
}

// The paper's PSO leaves the box, and the suite sees it.
TEST(MetaheuristicLaws, UnboundedPsoDoesNotKeepTheBox) {
  const auto violations = metaheuristic_violations(vernier::Pso{.particles = 10, .iterations = 20}, true);
  EXPECT_EQ(violations.size(), 1u);
  EXPECT_TRUE(mentions(violations, "a point outside the box was evaluated"));
}

TEST(MetaheuristicLaws, GeneticAlgorithms) {
  using Ga = vernier::GeneticAlgorithm;
  expect_laws(Ga{.individuals = 10, .generations = 20});
  expect_laws(Ga{.individuals = 9, .generations = 20, .elites = 3});
  expect_laws(Ga{.individuals = 10, .generations = 20, .bits = 16, .tournament = 1});
  expect_laws(Ga{.individuals = 10, .generations = 20, .elites = 0});
  expect_laws(Ga{.individuals = 8, .generations = 20, .bits = 1});
  using Real = vernier::RealGeneticAlgorithm;
  expect_laws(Real{.individuals = 9, .generations = 20, .elites = 3, .survival = Survival::elites});
  for (const auto selection : {ParentSelection::tournament, ParentSelection::roulette}) {
    expect_laws(Ga{.individuals = 11, .generations = 20, .crossover = BitCrossover::uniform, .selection = selection});
    for (const auto crossover :
         {RealCrossover::sbx, RealCrossover::blx, RealCrossover::one_point, RealCrossover::uniform})
      for (const auto mutation : {RealMutation::polynomial, RealMutation::gaussian})
        expect_laws(Real{.individuals = 10,
                         .generations = 20,
                         .mutations = 3,
                         .elites = 2,
                         .crossover = crossover,
                         .mutation = mutation,
                         .selection = selection,
                         .mutation_sigma = 2});
  }
}

TEST(MetaheuristicLaws, Spso2011) {
  expect_laws(vernier::Spso2011{.particles = 10, .iterations = 20});
  expect_laws(vernier::Spso2011{.particles = 1, .iterations = 20});
}

TEST(MetaheuristicLaws, DifferentialEvolution) {
  using De = vernier::DifferentialEvolution;
  for (const auto base : {DifferentialBase::random, DifferentialBase::best})
    for (const int individuals : {4, 15})
      expect_laws(De{.individuals = individuals, .generations = 20, .weight = 0.9, .base = base});
  expect_laws(De{.individuals = 9, .generations = 20, .weight = 2, .trials_outside = TrialRule::redrawn});
}

// Budgets that end within the law suite's twelve generations and beyond; populations shrink with every generation.
TEST(MetaheuristicLaws, LShade) {
  for (const Index budget : {72, 73, 300, 3000}) {
    SCOPED_TRACE(budget);
    expect_laws(vernier::LShade{.max_evaluations = budget});
  }
  expect_laws(vernier::LShade{.max_evaluations = 120, .individuals_per_dimension = 3, .archive_rate = 0});
}

// With coarse tolerances several runs fit in, each with a larger population.
TEST(MetaheuristicLaws, CmaEs) {
  expect_laws(vernier::CmaEs{.generations = 20});
  expect_laws(vernier::CmaEs{.individuals = 2, .generations = 20});
  expect_laws(vernier::CmaEs{.restarts = 4, .tolerance_x = 0.28});
  expect_laws(vernier::CmaEs{.restarts = 1, .growth = 3, .tolerance_x = 0.25});
}

TEST(MetaheuristicLaws, RandomSearchAndRestarts) {
  expect_laws(RandomSearch{.individuals = 7, .generations = 20});
  expect_laws(Restarted{RandomSearch{.individuals = 7, .generations = 0}});
  expect_laws(Restarted{vernier::Pso{.particles = 5, .iterations = 3}}, false);
  expect_laws(Restarted{vernier::GeneticAlgorithm{.individuals = 9, .generations = 2, .elites = 3}, 3});
  expect_laws(Restarted{vernier::LShade{.max_evaluations = 50, .individuals_per_dimension = 3}, 5});
}

enum class Fault {
  none,
  leaves_box,
  hides_state,
  ignores_seed,
  forgets_best,
  invents_best,
  takes_the_last,
  miscounts,
  announces_too_few,
};

/// Random search, right or with one fault.
struct PlantedSearch {
  Fault fault = Fault::none;
  Index points = 6;
  mutable Rng hidden{9};

  struct State {
    VectorX best;
    double best_fitness = std::numeric_limits<double>::infinity();
    Index generation = 0;
    Rng rng;
  };

  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    State s;
    s.rng = Rng(fault == Fault::ignores_seed ? 0 : seed);
    s.best = box.lower;
    evaluate_new(s, box, evaluate);
    return s;
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    evaluate_new(s, box, evaluate);
    s.generation += fault == Fault::miscounts ? 2 : 1;
  }
  bool done(const State&) const { return false; }
  Index next_evaluations(const State&) const { return fault == Fault::announces_too_few ? points - 1 : points; }

 private:
  void evaluate_new(State& s, const Box& box, Evaluate evaluate) const {
    MatrixX population(box.dimension(), points);
    Rng& rng = fault == Fault::hides_state && s.generation > 0 ? hidden : s.rng;
    for (Index k = 0; k < points; ++k)
      for (Index d = 0; d < box.dimension(); ++d) population(d, k) = rng.uniform(box.lower(d), box.upper(d));
    if (fault == Fault::leaves_box) population(0, 0) = box.upper(0) + 1e-9;
    VectorX values;
    evaluate(population, values);
    Index leader = 0;
    double value = values.minCoeff(&leader);
    if (fault == Fault::takes_the_last) value = values(leader = points - 1);
    const bool better = fault == Fault::forgets_best || fault == Fault::takes_the_last || value < s.best_fitness;
    if (!better) return;
    s.best_fitness = value;
    s.best = population.col(leader);
    if (fault == Fault::invents_best) s.best(0) += 1e-9;
  }
};

static_assert(Metaheuristic<Spso2011> && Metaheuristic<RealGeneticAlgorithm> && Metaheuristic<DifferentialEvolution> &&
              Metaheuristic<LShade> && Metaheuristic<CmaEs> && Metaheuristic<RandomSearch> &&
              Metaheuristic<Restarted<Restarted<CmaEs>>>);
static_assert(ListedState<Restarted<CmaEs>::State> && ListedState<vernier::GeneticAlgorithm::State>);
static_assert(Metaheuristic<vernier::Pso> && Metaheuristic<vernier::GeneticAlgorithm> && Metaheuristic<PlantedSearch>);

/// Near misses of the concept.
struct NoState {
  void step(int&, const Box&, Evaluate) const {}
};
struct StepNotConst : PlantedSearch {
  void step(State& s, const Box& box, Evaluate evaluate) { PlantedSearch::step(s, box, evaluate); }
};
struct StateWithoutBest : PlantedSearch {
  struct State {
    double best_fitness;
    Index generation;
  };
  State start(const Box&, std::uint64_t, Evaluate) const;
  void step(State&, const Box&, Evaluate) const;
  bool done(const State&) const;
  Index next_evaluations(const State&) const;
};
struct NoAnnouncement : PlantedSearch {
  Index next_evaluations() const;
};
static_assert(!Metaheuristic<NoAnnouncement> && !Metaheuristic<NoState> && !Metaheuristic<StepNotConst> &&
              !Metaheuristic<StateWithoutBest> && !Metaheuristic<int>);

constexpr auto scalar_objective = [](const VectorX& x) { return x.sum(); };
constexpr auto batch_objective = [](const Eigen::Ref<const MatrixX>& x, Eigen::Ref<VectorX> f) {
  f = x.colwise().sum().transpose();
};
constexpr auto no_objective = [](const VectorX& x) { return x; };
static_assert(ScalarObjective<decltype(scalar_objective)> && !BatchObjective<decltype(scalar_objective)>);
static_assert(BatchObjective<decltype(batch_objective)> && !ScalarObjective<decltype(batch_objective)>);
static_assert(!Objective<decltype(no_objective)> && !Objective<int>);

TEST(MetaheuristicLaws, UsersOwnSearch) { expect_laws(PlantedSearch{}); }

void expect_caught(Fault fault, const char* sentence) {
  const auto violations = metaheuristic_violations(PlantedSearch{.fault = fault}, true);
  EXPECT_TRUE(mentions(violations, sentence)) << sentence << no_violations(violations).message();
}

TEST(MetaheuristicLaws, CatchPlantedFaults) {
  expect_caught(Fault::leaves_box, "a point outside the box was evaluated");
  expect_caught(Fault::hides_state, "the same seed made another search");
  expect_caught(Fault::hides_state, "the algorithm hides state");
  expect_caught(Fault::hides_state, "a search that was paused and resumed came to another result");
  expect_caught(Fault::ignores_seed, "another seed made the same search");
  expect_caught(Fault::forgets_best, "the best value became worse");
  expect_caught(Fault::invents_best, "best is not the best point evaluated");
  expect_caught(Fault::takes_the_last, "best is not the best point evaluated");
  expect_caught(Fault::takes_the_last, "a value that is not finite became the best");
  expect_caught(Fault::miscounts, "step does not count its generation");
  expect_caught(Fault::announces_too_few, "a step evaluated more points than next_evaluations announced");
}

// Where an announcement is exceeded, the budget still is not: the search ends with an exception.
TEST(Minimize, RefusesMoreEvaluationsThanAnnounced) {
  Index calls = 0;
  const auto counting = [&](const VectorX& x) {
    ++calls;
    return x.sum();
  };
  const Box box = Box::cube(2, 0, 1);
  EXPECT_NE(complaint([&] {
              (void)minimize(PlantedSearch{.fault = Fault::announces_too_few}, counting, box, {.max_evaluations = 11});
            }).find("more points than the 5 that next_evaluations announced"),
            std::string::npos);
  EXPECT_EQ(calls, 6) << "the first population only";
}

// An upper bound is enough: what a step leaves of it can be spent later.
TEST(Minimize, AnAnnouncementMayBeAnUpperBound) {
  struct Cautious : PlantedSearch {
    Index next_evaluations(const State&) const { return 9; }
  };
  expect_laws(Cautious{});
  const auto objective = [](const VectorX& x) { return x.sum(); };
  // 6 at first; then 6 + 9 <= 20, 12 + 9 > 20
  EXPECT_EQ(minimize(Cautious{}, objective, Box::cube(2, 0, 1), {.max_evaluations = 20}).evaluations, 12);
  EXPECT_EQ(minimize(Cautious{}, objective, Box::cube(2, 0, 1), {.max_evaluations = 21}).evaluations, 18);
}

TEST(MetaheuristicLaws, NameOnlyWhatIsWrong) {
  EXPECT_EQ(metaheuristic_violations(PlantedSearch{.fault = Fault::leaves_box}, true).size(), 1u);
  EXPECT_TRUE(no_violations(metaheuristic_violations(PlantedSearch{.fault = Fault::leaves_box}, false)));
}

/// State behind the copy: two states share their engine, so each step of one moves the other.
struct SharedEngine {
  struct State : PlantedSearch::State {
    std::shared_ptr<Rng> engine;
  };
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    State s;
    static_cast<PlantedSearch::State&>(s) = PlantedSearch{}.start(box, seed, evaluate);
    s.engine = std::make_shared<Rng>(seed + 1);
    return s;
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    s.rng = *s.engine;
    PlantedSearch{}.step(s, box, evaluate);
    *s.engine = s.rng;
  }
  bool done(const State&) const { return false; }
  Index next_evaluations(const State&) const { return 6; }
};

TEST(MetaheuristicLaws, CatchStatesThatShareTheirEngine) {
  EXPECT_TRUE(mentions(metaheuristic_violations(SharedEngine{}, true), "a copied state continued differently"));
}

/// Evaluates another number of points with every generation, in one call or two.
struct BreathingSearch {
  Index grow = 1, calls = 1;
  using State = PlantedSearch::State;
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    return PlantedSearch{}.start(box, seed, evaluate);
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const Index n = points(s);
    for (Index call = 0; call < calls; ++call) {
      PlantedSearch{.points = n + call}.step(s, box, evaluate);
      if (call > 0) --s.generation;
    }
  }
  bool done(const State&) const { return false; }
  Index next_evaluations(const State& s) const { return calls * points(s) + calls * (calls - 1) / 2; }

 private:
  Index points(const State& s) const {
    return grow > 0 ? 6 + grow * s.generation : std::max<Index>(1, 40 + grow * s.generation);
  }
};

// Populations may grow, by leaps, and shrink, and be evaluated in several calls.
TEST(MetaheuristicLaws, PopulationsMayChangeSize) {
  for (const Index grow : {1, 50, -4})
    for (const Index calls : {1, 2}) expect_laws(BreathingSearch{.grow = grow, .calls = calls});
}

}  // namespace
}  // namespace vernier::metaheuristic_laws_test
