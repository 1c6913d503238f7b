// SPDX-License-Identifier: BSD-3-Clause
// Options of all searches: the limits of what is taken, and the schedule that they state.

#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>
#include <type_traits>

#include "limits.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/restarted.hpp"
#include "vernier/search/spso2011.hpp"

namespace vernier::search_options_test {
namespace {

using vernier_test::above;
using vernier_test::below;

const auto evaluate_squares = [](const MatrixX& population, VectorX& fitness) {
  fitness = population.colwise().squaredNorm().transpose();
};

/// What is not a number is outside wherever real numbers are asked for.
template <class Algorithm, class Value>
void expect_limits(const Algorithm& valid, Value Algorithm::*option, std::initializer_list<Value> inside,
                   std::initializer_list<Value> outside) {
  const auto start = [](const Algorithm& a) { a.start(Box::cube(2, -1, 1), 1, evaluate_squares); };
  vernier_test::expect_limits(start, valid, option, inside, outside);
  if constexpr (std::is_same_v<Value, double>)
    vernier_test::expect_limits(start, valid, option, {}, {std::numeric_limits<double>::quiet_NaN()});
}

TEST(SearchOptions, MessagesNameTheOptionAndItsValue) {
  const auto said = [](const auto& algorithm) {
    return vernier_test::complaint([&] { algorithm.start(Box::cube(2, -1, 1), 1, evaluate_squares); });
  };
  EXPECT_EQ(said(Pso{.particles = -3}), "Pso: particles is -3, must be at least 1");
  EXPECT_EQ(said(Spso2011{.iterations = -1}), "Spso2011: iterations is -1, must not be negative");
  EXPECT_EQ(said(CmaEs{.individuals = 1}), "CmaEs: individuals is 1, must be 0 or at least 2");
  EXPECT_EQ(said(DifferentialEvolution{.individuals = 3}),
            "DifferentialEvolution: individuals is 3, must be at least 4");
  EXPECT_EQ(said(LShade{.max_evaluations = 35}), "LShade: max_evaluations is 35, less than the first population of 36");
  EXPECT_EQ(said(RealGeneticAlgorithm{.individuals = 1}), "RealGeneticAlgorithm: individuals is 1, must be at least 2");
}

TEST(SearchOptions, LimitsOfPso) {
  expect_limits(Pso{}, &Pso::particles, {1}, {0});
  expect_limits(Pso{}, &Pso::iterations, {Index{0}}, {Index{-1}});
  expect_limits(Pso{}, &Pso::velocity_limit, {1e-9, below(1e6)}, {0.0, 1e6});
  for (const auto option : {&Pso::inertia_start, &Pso::inertia_end, &Pso::cognitive, &Pso::social})
    expect_limits(Pso{}, option, {0.0}, {below(0)});
}

TEST(SearchOptions, LimitsOfSpso2011) {
  expect_limits(Spso2011{}, &Spso2011::particles, {1}, {0});
  expect_limits(Spso2011{}, &Spso2011::iterations, {Index{0}}, {Index{-1}});
}

TEST(SearchOptions, LimitsOfGeneticAlgorithms) {
  using Binary = GeneticAlgorithm;
  expect_limits(Binary{}, &Binary::individuals, {2}, {1});
  expect_limits(Binary{}, &Binary::generations, {Index{0}}, {Index{-1}});
  expect_limits(Binary{}, &Binary::bits, {1, 16}, {0, 17});
  expect_limits(Binary{}, &Binary::tournament, {1}, {0});
  expect_limits(Binary{.individuals = 4}, &Binary::elites, {0, 3}, {-1, 4});
  for (const auto option : {&Binary::crossover_probability, &Binary::mutation_probability})
    expect_limits(Binary{}, option, {0.0, 1.0}, {below(0), above(1)});

  using Real = RealGeneticAlgorithm;
  expect_limits(Real{}, &Real::individuals, {2}, {1});
  expect_limits(Real{}, &Real::generations, {Index{0}}, {Index{-1}});
  expect_limits(Real{}, &Real::tournament, {1}, {0});
  expect_limits(Real{.individuals = 4}, &Real::elites, {0, 3}, {-1, 4});
  expect_limits(Real{}, &Real::crossover_probability, {0.0, 1.0}, {below(0), above(1)});
  expect_limits(Real{}, &Real::mutations, {0.0}, {below(0)});
  for (const auto option : {&Real::crossover_index, &Real::mutation_index})
    expect_limits(Real{}, option, {0.0, 1000.0}, {below(0), above(1000)});
  expect_limits(Real{}, &Real::blend, {0.0, 10.0}, {below(0), above(10)});
  expect_limits(Real{}, &Real::mutation_sigma, {1e-9, 10.0}, {0.0, above(10)});
}

TEST(SearchOptions, LimitsOfDifferentialEvolution) {
  using De = DifferentialEvolution;
  expect_limits(De{}, &De::individuals, {4}, {3});
  expect_limits(De{}, &De::generations, {Index{0}}, {Index{-1}});
  expect_limits(De{}, &De::weight, {1e-9, 10.0}, {0.0, above(10)});
  expect_limits(De{}, &De::crossover_probability, {0.0, 1.0}, {below(0), above(1)});

  expect_limits(LShade{}, &LShade::individuals_per_dimension, {1e-9}, {0.0, above(1e6)});
  // as many as that have a schedule that takes them
  expect_limits(LShade{.max_evaluations = 2'000'000}, &LShade::individuals_per_dimension, {1e6}, {});
  expect_limits(LShade{}, &LShade::memory, {1}, {0});
  expect_limits(LShade{}, &LShade::archive_rate, {0.0, 1000.0}, {below(0), above(1000)});
  expect_limits(LShade{}, &LShade::best_share, {0.0, 1.0}, {below(0), above(1)});
  expect_limits(LShade{}, &LShade::max_evaluations, {Index{36}}, {Index{35}});  // 18 individuals per dimension
}

TEST(SearchOptions, LimitsOfCmaEs) {
  expect_limits(CmaEs{}, &CmaEs::individuals, {0, 2}, {-1, 1});
  expect_limits(CmaEs{}, &CmaEs::generations, {Index{0}}, {Index{-1}});
  expect_limits(CmaEs{}, &CmaEs::sigma, {1e-9, 100.0}, {0.0, above(100)});
  expect_limits(CmaEs{}, &CmaEs::restarts, {0, 30}, {-1, 31});
  expect_limits(CmaEs{}, &CmaEs::growth, {1.0, 10.0}, {below(1), above(10)});
  for (const auto option : {&CmaEs::tolerance_x, &CmaEs::tolerance_f})
    expect_limits(CmaEs{}, option, {0.0}, {below(0)});
}

TEST(SearchOptions, LimitsOfRandomSearchAndRestarts) {
  expect_limits(RandomSearch{}, &RandomSearch::individuals, {1}, {0});
  expect_limits(RandomSearch{}, &RandomSearch::generations, {Index{0}}, {Index{-1}});
  using Again = Restarted<Pso>;
  expect_limits(Again{}, &Again::restarts, {Index{0}}, {Index{-1}});
}

// A state of restarts is sound where the run is and its best point has as many coordinates as that run's.
TEST(SearchOptions, InconsistentStatesOfRestartsAreSeen) {
  const auto evaluate = [](const MatrixX& points, VectorX& values) { values = points.colwise().squaredNorm(); };
  const auto made = Restarted<Pso>{.algorithm = {.particles = 3}}.start(Box::cube(2, 0, 1), 1, evaluate);
  EXPECT_TRUE(made.consistent());
  auto other = made;
  other.best = VectorX::Zero(3);
  EXPECT_FALSE(other.consistent());
  other = made;
  other.current.fitness = VectorX::Zero(4);
  EXPECT_FALSE(other.consistent());
}

double squares(const VectorX& x) { return x.squaredNorm(); }

/// A search makes as many generations as its schedule states, each of as many evaluations.
template <class Algorithm>
void expect_schedule(const Algorithm& algorithm, Index generations, Index first, Index each) {
  const SearchResult found = minimize(algorithm, squares, Box::cube(3, -1, 1));
  EXPECT_EQ(found.status, SearchStatus::schedule_ended);
  EXPECT_EQ(found.generations, generations);
  EXPECT_EQ(found.evaluations, first + generations * each);
}

TEST(SearchOptions, SchedulesAreKept) {
  expect_schedule(Pso{.particles = 6, .iterations = 7}, 7, 6, 6);
  expect_schedule(Spso2011{.particles = 6, .iterations = 7}, 7, 6, 6);
  expect_schedule(GeneticAlgorithm{.individuals = 6, .generations = 7}, 7, 6, 5);
  expect_schedule(RealGeneticAlgorithm{.individuals = 6, .generations = 7}, 7, 6, 6);
  expect_schedule(RealGeneticAlgorithm{.individuals = 6, .generations = 7, .elites = 2, .survival = Survival::elites},
                  7, 6, 4);
  expect_schedule(DifferentialEvolution{.individuals = 6, .generations = 7}, 7, 6, 6);
  expect_schedule(RandomSearch{.individuals = 6, .generations = 7}, 7, 6, 6);
  expect_schedule(CmaEs{.individuals = 6, .generations = 7}, 7, 6, 6);
  expect_schedule(Restarted<Pso>{.algorithm = {.particles = 6, .iterations = 2}, .restarts = 1}, 5, 6, 6);
}

}  // namespace
}  // namespace vernier::search_options_test
