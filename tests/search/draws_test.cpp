// SPDX-License-Identifier: BSD-3-Clause
// What searches draw, with the random numbers drawn again, and when runs of CMA-ES end.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/argsort.hpp"
#include "vernier/search/bounds.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/parent_selection.hpp"
#include "vernier/search/pso.hpp"

namespace vernier::draws_test {
namespace {

using vernier_test::vector;

void evaluate_bowl(const MatrixX& population, VectorX& fitness) {
  fitness.resize(population.cols());
  for (Index k = 0; k < population.cols(); ++k) fitness(k) = population.col(k).squaredNorm();
}

/// The first population of a run: a mean anywhere in the box, and normal steps around it, mirrored at the bounds.
void expect_first_population(const MatrixX& asked, const Box& box, double sigma, Rng rng) {
  VectorX mean(asked.rows());
  for (double& value : mean) value = rng.uniform();
  std::vector<double> z;
  while (z.size() + 1 < static_cast<std::size_t>(asked.size()))
    for (const double value : rng.normal_pair()) z.push_back(value);
  if (z.size() < static_cast<std::size_t>(asked.size())) z.push_back(rng.normal());
  int mirrored = 0;
  for (Index k = 0; k < asked.size(); ++k) {
    const Index d = k % asked.rows();
    const double at = mean(d) + sigma * z[static_cast<std::size_t>(k)], inside = reflected(at, 0, 1);
    mirrored += inside != at;
    EXPECT_NEAR(asked.data()[k], box.lower(d) + (box.upper(d) - box.lower(d)) * inside, 1e-12);
  }
  EXPECT_GT(mirrored, 0);
}

TEST(CmaEsDraws, EveryRunBeginsAnywhere) {
  const Box box{vector({-1, 0, 2}), vector({1, 5, 4})};
  const CmaEs cma{.sigma = 0.4};
  MatrixX asked;
  const auto watch = [&](const MatrixX& population, VectorX& fitness) {
    asked = population;
    evaluate_bowl(population, fitness);
  };
  for (const std::uint64_t seed : {1u, 2u}) {
    CmaEs::State s = cma.start(box, seed, watch);
    ASSERT_EQ(asked.cols(), 7);
    expect_first_population(asked, box, 0.4, Rng(seed));
    s.converged = true;
    const Rng before = s.rng;
    cma.step(s, box, watch);
    ASSERT_EQ(asked.cols(), 14);
    EXPECT_EQ(s.run, 1);
    expect_first_population(asked, box, 0.4, before);
  }
}

// A constant objective: a run ends when its history of 10 + 30 n / lambda best values, rounded up, is full; the history
// of the next begins anew.
TEST(CmaEsEnds, WhereTheHistoryIsFlat) {
  const auto constant = [](const VectorX&) { return 2.0; };
  const Box box = Box::cube(3, -1, 2);
  const SearchResult once = minimize(CmaEs{.generations = 5000}, constant, box, {}, 1);
  EXPECT_EQ(once.status, SearchStatus::schedule_ended);
  EXPECT_EQ(once.generations, 22);  // the first population is one of 23 = 10 + ceil(90 / 7)
  const SearchResult twice = minimize(CmaEs{.generations = 5000, .restarts = 1}, constant, box, {}, 1);
  EXPECT_EQ(twice.generations, 22 + 17);  // 10 + ceil(90 / 14)
}

TEST(CmaEsEnds, NotWhereTheBestAloneIsFlat) {
  const auto ranks = [](const MatrixX& population, VectorX& fitness) {
    fitness = VectorX::LinSpaced(population.cols(), 0, 6);
  };
  const CmaEs cma;
  const Box box = Box::cube(3, -1, 2);
  CmaEs::State s = cma.start(box, 1, ranks);
  for (int step = 0; step < 40; ++step) {
    cma.step(s, box, ranks);
    ASSERT_FALSE(s.converged) << step;
  }
}

// C takes its path in unless that of sigma is longer than 1.4 + 2 / (n + 1) times expected, by what it has had time to
// grow to; all points at the mean, so that nothing else changes C.
TEST(CmaEsSteps, APathThatIsTooLongIsLeftOut) {
  const Index n = 4, lambda = 9;
  const CmaEsConstants c(n, lambda);
  std::vector<Index> order;
  for (Index k = 0; k < lambda; ++k) order.push_back(k);
  for (const int updates : {0, 7})
    for (const double share : {0.99, 1.01}) {
      CmaEs::State s;
      s.covariance = s.basis = MatrixX::Identity(n, n);
      s.scales = VectorX::Ones(n);
      s.mean = s.path_c = s.path_sigma = VectorX::Zero(n);
      s.sigma = 1;
      s.updates = s.decomposed = updates;
      const double grown = std::sqrt(1 - std::pow(1 - c.c_sigma, 2.0 * (updates + 1)));
      s.path_sigma(1) = share * (1.4 + 2.0 / 5) * c.expected_norm * grown / (1 - c.c_sigma);
      CmaEs::update(s, MatrixX::Zero(n, lambda), order);
      const double made_up = share < 1 ? 0 : c.c_1 * c.c_c * (2 - c.c_c);
      EXPECT_NEAR(s.covariance(0, 0), 1 - c.c_1 - c.c_mu * c.weights.sum() + made_up, 1e-12) << updates << ' ' << share;
    }
}

// In many dimensions C changes little in a step, and is decomposed after 1 / (10 n (c_1 + c_mu)) of them.
TEST(CmaEsSteps, DecomposeNowAndThen) {
  const Index n = 200;
  const CmaEs cma;
  const Box box = Box::cube(n, -1, 2);
  CmaEs::State s = cma.start(box, 1, evaluate_bowl);
  const CmaEsConstants c(n, s.individuals);
  const double interval = 1 / (10 * static_cast<double>(n) * (c.c_1 + c.c_mu));
  ASSERT_GT(interval, 2);
  ASSERT_LT(interval, 3);
  for (int step = 0; step < 8; ++step) {
    EXPECT_EQ(s.decomposed, s.updates / 3 * 3) << s.updates;
    cma.step(s, box, evaluate_bowl);
  }
}

// Every trial from its formula: F and CR around a pair that is remembered, Cauchy and normal of size 0.1; towards one
// of the best, and by the difference of two others, the second of whom may be from the archive.
TEST(LShadeDraws, TrialsByHand) {
  const Box box = Box::cube(3, -1, 1);
  int archived = 0, repaired = 0, capped = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // a quarter of eight are the best two, and there are two at least
    const LShade shade{.individuals_per_dimension = 8.0 / 3, .best_share = seed % 2 == 0 ? 0.25 : 0};
    LShade::State s = shade.start(box, seed, evaluate_bowl);
    ASSERT_EQ(s.positions.cols(), 8);
    s.archive = MatrixX::Constant(3, 3, 0.75);
    s.archive.col(1).setConstant(-0.5);
    s.weights = vector({0.3, 0.9});
    s.crossover_rates = vector({0.6, -1});  // -1: none but the certain one
    s.oldest = 0;
    const MatrixX x = s.positions, archive = s.archive;
    const std::vector<Index> order = argsort(s.fitness);
    Rng rng = s.rng;
    MatrixX asked;
    shade.step(s, box, [&](const MatrixX& trials, VectorX& fitness) {
      asked = trials;
      evaluate_bowl(trials, fitness);
    });
    ASSERT_EQ(asked.cols(), 8);
    for (Index k = 0; k < 8; ++k) {
      const bool first = rng.below(2) == 0;
      const double cr = first ? std::clamp(0.6 + 0.1 * rng.normal(), 0.0, 1.0) : 0;
      none += !first;
      double f = 0;
      while (!(f > 0)) {
        const double drawn = (first ? 0.3 : 0.9) + 0.1 * std::tan(std::numbers::pi * (rng.uniform() - 0.5));
        capped += drawn > 1;
        f = std::min(1.0, drawn);
      }
      const Index leader = order[rng.below(2)];
      const auto drawn_besides = [&](std::uint64_t n, std::vector<Index> others) {
        for (;;) {
          const auto drawn = static_cast<Index>(rng.below(n));
          if (std::find(others.begin(), others.end(), drawn) == others.end()) return drawn;
        }
      };
      const Index r1 = drawn_besides(8, {k}), r2 = drawn_besides(11, {k, r1});
      archived += r2 >= 8;
      const auto certain = static_cast<Index>(rng.below(3));
      for (Index d = 0; d < 3; ++d) {
        const bool takes = rng.uniform() < cr || d == certain;
        const double other = r2 < 8 ? x(d, r2) : archive(d, r2 - 8);
        const double mutant = x(d, k) + f * (x(d, leader) - x(d, k)) + f * (x(d, r1) - other);
        repaired += takes && std::abs(mutant) > 1;
        EXPECT_NEAR(asked(d, k), takes ? halfway(mutant, x(d, k), -1, 1) : x(d, k), 1e-14);
      }
    }
  }
  EXPECT_GT(std::min({archived, repaired, capped, none}), 3);
}

// A trial that is as good as its target takes its place: a plateau is crossed.
TEST(DifferentialEvolutionDraws, EqualTrialsAreTaken) {
  const auto constant = [](const MatrixX& population, VectorX& fitness) { fitness = VectorX::Ones(population.cols()); };
  const Box box = Box::cube(2, -1, 1);
  const DifferentialEvolution de{.individuals = 8};
  DifferentialEvolution::State s = de.start(box, 1, constant);
  MatrixX asked;
  de.step(s, box, [&](const MatrixX& trials, VectorX& fitness) {
    asked = trials;
    constant(trials, fitness);
  });
  EXPECT_EQ(s.positions, asked);
}

// A particle keeps its best place until a better one is found.
TEST(SwarmDraws, APlaceAsGoodIsNoBetter) {
  const auto constant = [](const MatrixX& population, VectorX& fitness) { fitness = VectorX::Ones(population.cols()); };
  const Box box = Box::cube(2, -1, 1);
  const Pso pso{.particles = 6};
  Pso::State s = pso.start(box, 1, constant);
  const MatrixX first = s.positions;
  pso.step(s, box, constant);
  EXPECT_EQ(s.best_positions, first);
  EXPECT_NE(s.positions, first);
}

// Parents are drawn in proportion to their advantage over the worst finite individual; one that is not finite is never
// drawn.
TEST(Roulette, TurnsAlsoWithValuesThatAreNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto counts = [](const VectorX& fitness, int tournament) {
    const ParentSelector select(ParentSelection::roulette, tournament, fitness);
    std::vector<int> out(static_cast<std::size_t>(fitness.size()));
    Rng rng(7);
    for (int k = 0; k < 900; ++k) ++out[static_cast<std::size_t>(select(rng))];
    return out;
  };
  EXPECT_EQ(counts(vector({infinity, 1, 4, infinity}), 3), (std::vector<int>{0, 900, 0, 0}));
  const std::vector<int> two = counts(vector({3, infinity, 1, 4}), 3);  // 1 to 3
  EXPECT_EQ(two[1] + two[3], 0);
  EXPECT_NEAR(two[0], 225, 4 * 13);
  // where there is nothing to prefer, or it cannot be told, all have the same chance
  for (const VectorX level :
       {vector({5, 5, 5}), vector({infinity, infinity, infinity}), vector({-1e308, -1e308, 1e308})})
    for (const int count : counts(level, 5)) EXPECT_NEAR(count, 300, 4 * 14.2);
}

}  // namespace
}  // namespace vernier::draws_test
