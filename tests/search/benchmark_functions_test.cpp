// SPDX-License-Identifier: BSD-3-Clause
// Medians over 25 seeds on three classical functions, under stated targets, beside random sampling of the same size.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/spso2011.hpp"

namespace vernier::benchmark_functions_test {
namespace {

/// All have their minimum 0 off the centre of the box and off every bound, so that nothing finds it by symmetry.
double sphere(const VectorX& x) { return (x.array() - 0.7).square().sum(); }

double rosenbrock(const VectorX& x) {
  double sum = 0;
  for (Index i = 0; i + 1 < x.size(); ++i) sum += 100 * std::pow(x(i + 1) - x(i) * x(i), 2) + std::pow(1 - x(i), 2);
  return sum;
}

double rastrigin(const VectorX& x) {
  double sum = 0;
  for (const double value : x) {
    const double z = value - 0.7;
    sum += z * z + 10 - 10 * std::cos(2 * std::numbers::pi * z);
  }
  return sum;
}

constexpr int seeds = 25;

template <class Run>
double median(const Run& run) {
  std::vector<double> values;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) values.push_back(run(seed));
  std::sort(values.begin(), values.end());
  return values[seeds / 2];
}

template <class A, class F>
double median_of(const A& algorithm, const F& objective, const Box& box, Index budget) {
  return median([&](std::uint64_t seed) {
    const SearchResult result = minimize(algorithm, objective, box, {.max_evaluations = budget}, seed);
    EXPECT_LE(result.evaluations, budget);
    EXPECT_GT(result.evaluations, budget - 60);
    return result.best_fitness;
  });
}

template <class F>
double median_of_random_sampling(const F& objective, const Box& box, Index budget) {
  return median([&](std::uint64_t seed) {
    Rng rng(seed);
    double best = std::numeric_limits<double>::infinity();
    VectorX x(box.dimension());
    for (Index i = 0; i < budget; ++i) {
      for (Index d = 0; d < x.size(); ++d) x(d) = rng.uniform(box.lower(d), box.upper(d));
      best = std::min(best, objective(x));
    }
    return best;
  });
}

struct Targets {
  double pso, ga, constriction, ring, spso, real_ga, de, l_shade, cma;
};

/// 40 particles or 41 individuals (one elite is not evaluated again), 200 generations: some 8,040 evaluations, for
/// L-SHADE and CMA-ES in populations of their own size. Each
/// median must stay below its target; random sampling of that size, a swarm without its common pull and a GA without
/// selection must miss it clearly.
template <class F>
void expect_medians(const F& objective, const Box& box, const Targets& targets) {
  const Index budget = 8041;
  const Pso pso{.particles = 40, .iterations = 200};
  Pso clamped = pso, unsocial = pso;
  clamped.positions = PositionRule::clamped;
  unsocial.social = 0;
  const GeneticAlgorithm ga{.individuals = 41, .generations = 200, .bits = 16};
  GeneticAlgorithm unselective = ga;
  unselective.tournament = 1;
  unselective.elites = 0;

  EXPECT_LT(median_of(pso, objective, box, budget), targets.pso);
  EXPECT_LT(median_of(clamped, objective, box, budget), targets.pso);
  EXPECT_LT(median_of(ga, objective, box, budget), targets.ga);
  const double random = median_of_random_sampling(objective, box, budget);
  EXPECT_GT(random, 2 * std::max(targets.pso, targets.ga));
  EXPECT_NEAR(median_of(RandomSearch{.individuals = 40, .generations = 200}, objective, box, 8040) / random, 1, 0.5);

  Pso constriction = Pso::constriction();
  constriction.particles = 40;
  constriction.iterations = 200;
  EXPECT_LT(median_of(constriction, objective, box, budget), targets.constriction);
  for (const Neighbourhood neighbourhood : {Neighbourhood::ring, Neighbourhood::von_neumann}) {
    Pso local = constriction;
    local.neighbourhood = neighbourhood;
    local.positions = PositionRule::reflected;
    EXPECT_LT(median_of(local, objective, box, budget), targets.ring);
  }
  EXPECT_LT(median_of(Spso2011{.iterations = 200}, objective, box, budget), targets.spso);
  EXPECT_LT(median_of(RealGeneticAlgorithm{.individuals = 41, .generations = 200}, objective, box, budget),
            targets.real_ga);
  EXPECT_LT(median_of(DifferentialEvolution{.individuals = 40, .generations = 200}, objective, box, budget),
            targets.de);
  EXPECT_LT(median_of(LShade{.max_evaluations = 8040}, objective, box, budget), targets.l_shade);
  // a run may converge before the budget is spent
  EXPECT_LT(median([&](std::uint64_t seed) {
              return minimize(CmaEs{.restarts = 9}, objective, box, {.max_evaluations = budget}, seed).best_fitness;
            }),
            targets.cma);
  EXPECT_GT(median_of(unsocial, objective, box, budget), 2 * targets.pso);
  EXPECT_GT(median_of(unselective, objective, box, budget), 2 * targets.ga);
}

// clang-format off
constexpr Targets of_sphere{.pso = 1e-4, .ga = 1.6, .constriction = 1e-7, .ring = 1e-3, .spso = 1e-8,
                            .real_ga = 0.02, .de = 1e-6, .l_shade = 1e-5, .cma = 1e-12};
constexpr Targets of_rosenbrock{.pso = 1, .ga = 6, .constriction = 1, .ring = 1, .spso = 0.5,
                                .real_ga = 2, .de = 0.2, .l_shade = 1e-12, .cma = 1e-12};
constexpr Targets of_rastrigin{.pso = 4, .ga = 8, .constriction = 4, .ring = 4, .spso = 7,
                               .real_ga = 0.5, .de = 11, .l_shade = 1e-3, .cma = 5};
// clang-format on

TEST(Medians, SphereOfTenDimensions) { expect_medians(sphere, Box::cube(10, -5, 5), of_sphere); }
TEST(Medians, RosenbrockOfFourDimensions) { expect_medians(rosenbrock, Box::cube(4, -5, 5), of_rosenbrock); }
TEST(Medians, RastriginOfSixDimensions) { expect_medians(rastrigin, Box::cube(6, -5.12, 5.12), of_rastrigin); }

}  // namespace
}  // namespace vernier::benchmark_functions_test
