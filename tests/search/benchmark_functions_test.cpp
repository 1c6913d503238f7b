// Medians over 25 seeds on three classical functions, under stated targets, beside random sampling of the same size.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"

namespace vernier {
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
  double pso, ga;
};

/// 40 particles or 41 individuals (one elite is not evaluated again), 200 generations: some 8,040 evaluations. Each
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
  EXPECT_GT(median_of_random_sampling(objective, box, budget), 2 * std::max(targets.pso, targets.ga));
  EXPECT_GT(median_of(unsocial, objective, box, budget), 2 * targets.pso);
  EXPECT_GT(median_of(unselective, objective, box, budget), 2 * targets.ga);
}

TEST(Medians, SphereOfTenDimensions) { expect_medians(sphere, Box::cube(10, -5, 5), {1e-4, 1.6}); }
TEST(Medians, RosenbrockOfFourDimensions) { expect_medians(rosenbrock, Box::cube(4, -5, 5), {1, 6}); }
TEST(Medians, RastriginOfSixDimensions) { expect_medians(rastrigin, Box::cube(6, -5.12, 5.12), {4, 8}); }

}  // namespace
}  // namespace vernier
