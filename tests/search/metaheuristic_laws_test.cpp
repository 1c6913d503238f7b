// Every algorithm through the laws of its concept, and the laws against planted faults.

#include "vernier/testing/metaheuristic_laws.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "laws.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"

namespace vernier {
namespace {

using testing::metaheuristic_violations;
using vernier_test::mentions;
using vernier_test::no_violations;

TEST(MetaheuristicLaws, Pso) {
  EXPECT_TRUE(no_violations(metaheuristic_violations(vernier::Pso{.particles = 10, .iterations = 20}, false)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(
      vernier::Pso{.particles = 10, .iterations = 20, .positions = PositionRule::clamped}, true)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(vernier::Pso{.particles = 1, .iterations = 5}, false)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(vernier::Pso{.particles = 3, .iterations = 0}, true)));
}

// The paper's PSO leaves the box, and the suite sees it.
TEST(MetaheuristicLaws, UnboundedPsoDoesNotKeepTheBox) {
  const auto violations = metaheuristic_violations(vernier::Pso{.particles = 10, .iterations = 20}, true);
  EXPECT_EQ(violations.size(), 1u);
  EXPECT_TRUE(mentions(violations, "a point outside the box was evaluated"));
}

TEST(MetaheuristicLaws, GeneticAlgorithm) {
  using Ga = vernier::GeneticAlgorithm;
  EXPECT_TRUE(no_violations(metaheuristic_violations(Ga{.individuals = 10, .generations = 20}, true)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(Ga{.individuals = 9, .generations = 20, .elites = 3}, true)));
  EXPECT_TRUE(no_violations(
      metaheuristic_violations(Ga{.individuals = 10, .generations = 20, .bits = 16, .tournament = 1}, true)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(Ga{.individuals = 10, .generations = 20, .elites = 0}, true)));
  EXPECT_TRUE(no_violations(metaheuristic_violations(Ga{.individuals = 8, .generations = 20, .bits = 1}, true)));
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
};

/// Random search, right or with one fault.
struct RandomSearch {
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
    look(s, box, evaluate);
    return s;
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    look(s, box, evaluate);
    s.generation += fault == Fault::miscounts ? 2 : 1;
  }
  bool done(const State&) const { return false; }

 private:
  void look(State& s, const Box& box, Evaluate evaluate) const {
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

static_assert(Metaheuristic<vernier::Pso> && Metaheuristic<vernier::GeneticAlgorithm> && Metaheuristic<RandomSearch>);

/// Near misses of the concept.
struct NoState {
  void step(int&, const Box&, Evaluate) const {}
};
struct StepNotConst : RandomSearch {
  void step(State& s, const Box& box, Evaluate evaluate) { RandomSearch::step(s, box, evaluate); }
};
struct StateWithoutBest : RandomSearch {
  struct State {
    double best_fitness;
    Index generation;
  };
  State start(const Box&, std::uint64_t, Evaluate) const;
  void step(State&, const Box&, Evaluate) const;
  bool done(const State&) const;
};
static_assert(!Metaheuristic<NoState> && !Metaheuristic<StepNotConst> && !Metaheuristic<StateWithoutBest> &&
              !Metaheuristic<int>);

constexpr auto scalar_objective = [](const VectorX& x) { return x.sum(); };
constexpr auto batch_objective = [](const Eigen::Ref<const MatrixX>& x, Eigen::Ref<VectorX> f) {
  f = x.colwise().sum().transpose();
};
constexpr auto no_objective = [](const VectorX& x) { return x; };
static_assert(ScalarObjective<decltype(scalar_objective)> && !BatchObjective<decltype(scalar_objective)>);
static_assert(BatchObjective<decltype(batch_objective)> && !ScalarObjective<decltype(batch_objective)>);
static_assert(!Objective<decltype(no_objective)> && !Objective<int>);

TEST(MetaheuristicLaws, UsersOwnRandomSearch) {
  EXPECT_TRUE(no_violations(metaheuristic_violations(RandomSearch{}, true)));
}

void expect_caught(Fault fault, const char* sentence) {
  const auto violations = metaheuristic_violations(RandomSearch{.fault = fault}, true);
  EXPECT_TRUE(mentions(violations, sentence)) << sentence << no_violations(violations).message();
}

TEST(MetaheuristicLaws, CatchPlantedFaults) {
  expect_caught(Fault::leaves_box, "a point outside the box was evaluated");
  expect_caught(Fault::hides_state, "the same seed searched elsewhere");
  expect_caught(Fault::hides_state, "the algorithm hides state");
  expect_caught(Fault::ignores_seed, "another seed made the same search");
  expect_caught(Fault::forgets_best, "the best value became worse");
  expect_caught(Fault::invents_best, "best is not the best point evaluated");
  expect_caught(Fault::takes_the_last, "best is not the best point evaluated");
  expect_caught(Fault::takes_the_last, "a value that is not finite became the best");
  expect_caught(Fault::miscounts, "step does not count its generation");
}

TEST(MetaheuristicLaws, NameOnlyWhatIsWrong) {
  EXPECT_EQ(metaheuristic_violations(RandomSearch{.fault = Fault::leaves_box}, true).size(), 1u);
  EXPECT_TRUE(no_violations(metaheuristic_violations(RandomSearch{.fault = Fault::leaves_box}, false)));
}

/// State behind the copy: two states share their engine, so each step of one moves the other.
struct SharedEngine {
  struct State : RandomSearch::State {
    std::shared_ptr<Rng> engine;
  };
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    State s;
    static_cast<RandomSearch::State&>(s) = RandomSearch{}.start(box, seed, evaluate);
    s.engine = std::make_shared<Rng>(seed + 1);
    return s;
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    s.rng = *s.engine;
    RandomSearch{}.step(s, box, evaluate);
    *s.engine = s.rng;
  }
  bool done(const State&) const { return false; }
};

TEST(MetaheuristicLaws, CatchStatesThatShareTheirEngine) {
  EXPECT_TRUE(mentions(metaheuristic_violations(SharedEngine{}, true), "a copied state went on differently"));
}

/// Looks at more points with every generation.
struct GrowingSearch {
  using State = RandomSearch::State;
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    return RandomSearch{}.start(box, seed, evaluate);
  }
  void step(State& s, const Box& box, Evaluate evaluate) const {
    RandomSearch{.points = 6 + s.generation}.step(s, box, evaluate);
  }
  bool done(const State&) const { return false; }
};

// A population that grows from step to step is allowed; its evaluations are counted as they come.
TEST(MetaheuristicLaws, PopulationsMayGrow) {
  EXPECT_TRUE(no_violations(metaheuristic_violations(GrowingSearch{}, true)));
}

}  // namespace
}  // namespace vernier
