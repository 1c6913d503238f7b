// SPDX-License-Identifier: BSD-3-Clause
// Both forms by hand, with the random numbers drawn again; L-SHADE's memory, archive and shrinking population.

#include "vernier/search/differential_evolution.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "vernier/search/l_shade.hpp"

namespace vernier::differential_evolution_test {
namespace {

const auto evaluate_bowl = [](const MatrixX& population, VectorX& fitness) {
  fitness = population.colwise().squaredNorm().transpose();
};

// Every trial from its formula: three others drawn by rejection, one certain dimension, the rest by CR, a bound passed
// becomes the middle between it and the parent or a new number.
TEST(DifferentialEvolution, TrialsByHand) {
  const Box box{Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1)};
  for (const auto& [base, rule] : {std::pair{DifferentialBase::random, TrialRule::halfway},
                                   {DifferentialBase::best, TrialRule::halfway},
                                   {DifferentialBase::random, TrialRule::redrawn}}) {
    const DifferentialEvolution de{.individuals = 6,
                                   .generations = 5,
                                   .weight = 0.9,
                                   .crossover_probability = 0.6,
                                   .base = base,
                                   .trials_outside = rule};
    DifferentialEvolution::State s = de.start(box, 3, evaluate_bowl);
    int repaired = 0, taken = 0, kept = 0;
    for (int generation = 0; generation < 5; ++generation) {
      const DifferentialEvolution::State before = s;
      Rng rng = s.rng;
      MatrixX asked;
      const auto watch = [&](const MatrixX& population, VectorX& fitness) {
        asked = population;
        evaluate_bowl(population, fitness);
      };
      de.step(s, box, watch);
      for (Index k = 0; k < 6; ++k) {
        std::vector<Index> r;
        while (r.size() < 3) {
          const auto drawn = static_cast<Index>(rng.below(6));
          if (drawn != k && std::find(r.begin(), r.end(), drawn) == r.end()) r.push_back(drawn);
        }
        const auto certain = static_cast<Index>(rng.below(3));
        for (Index d = 0; d < 3; ++d) {
          const bool takes = rng.uniform() < 0.6 || d == certain;
          const double from = base == DifferentialBase::best ? before.best(d) : before.positions(d, r[0]);
          double expected = before.positions(d, k);
          if (takes) {
            const double mutant = from + 0.9 * (before.positions(d, r[1]) - before.positions(d, r[2]));
            const double bound = mutant < -1 ? -1 : 1;
            repaired += std::abs(mutant) > 1;
            expected = std::abs(mutant) <= 1        ? mutant
                       : rule == TrialRule::halfway ? (bound + expected) / 2
                                                    : rng.uniform(-1, 1);
          }
          ASSERT_NEAR(asked(d, k), expected, 1e-15);
        }
        const bool better = asked.col(k).squaredNorm() <= before.fitness(k);
        (better ? taken : kept) += 1;
        ASSERT_EQ(s.positions.col(k), (better ? asked : before.positions).col(k));
        ASSERT_EQ(s.fitness(k), s.positions.col(k).squaredNorm());
      }
    }
    EXPECT_GT(repaired, 3);
    EXPECT_GT(taken, 3);
    EXPECT_GT(kept, 3);
  }
}

// Three trials: gains 2, 0 and 6, so weights 1/4 and 3/4 of F 0.4 and 0.8, CR 0.2 and 1:
// F: (0.25 0.16 + 0.75 0.64) / (0.25 0.4 + 0.75 0.8) = 0.52 / 0.7; CR: (0.01 + 0.75) / (0.05 + 0.75) = 0.95.
TEST(LShade, RemembersByHand) {
  LShade::State s;
  s.fitness = Eigen::Vector3d(5, 3, 7);
  s.weights = s.crossover_rates = Eigen::Vector2d(0.5, 0.5);
  LShade::remember(s, Eigen::Vector3d(3, 3, 1), Eigen::Vector3d(0.4, 0.9, 0.8), Eigen::Vector3d(0.2, 0.7, 1));
  EXPECT_NEAR(s.weights(0), 0.52 / 0.7, 1e-15);
  EXPECT_NEAR(s.crossover_rates(0), 0.95, 1e-15);
  EXPECT_EQ(s.weights(1), 0.5);
  EXPECT_EQ(s.oldest, 1);
  // nothing succeeds: nothing changes
  LShade::remember(s, Eigen::Vector3d(5, 3, 8), Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(s.oldest, 1);
  EXPECT_EQ(s.weights(1), 0.5);
  // all CR that succeeded are zero: the rate stays zero from then on
  LShade::remember(s, Eigen::Vector3d(4, 3, 8), Eigen::Vector3d(0.3, 1, 1), Eigen::Vector3d(0, 1, 1));
  EXPECT_LT(s.crossover_rates(1), 0);
  EXPECT_NEAR(s.weights(1), 0.3, 1e-15);
  EXPECT_EQ(s.oldest, 0);
  s.oldest = 1;
  LShade::remember(s, Eigen::Vector3d(4, 3, 8), Eigen::Vector3d(0.6, 1, 1), Eigen::Vector3d(1, 1, 1));
  EXPECT_LT(s.crossover_rates(1), 0);
  EXPECT_NEAR(s.weights(1), 0.6, 1e-15);
  // an infinite value bettered weighs as much as the greatest finite gain
  s.fitness(0) = std::numeric_limits<double>::infinity();
  LShade::remember(s, Eigen::Vector3d(4, 1, 8), Eigen::Vector3d(0.2, 0.6, 1), Eigen::Vector3d(0.5, 0.5, 1));
  EXPECT_NEAR(s.weights(0), (0.04 + 0.36) / 0.8, 1e-15);
  // ... however small that is: gains infinite, 0.25 and 0.125 weigh as 2, 2 and 1
  s.oldest = 0;
  s.fitness = Eigen::Vector3d(std::numeric_limits<double>::infinity(), 1, 1);
  LShade::remember(s, Eigen::Vector3d(9, 0.75, 0.875), Eigen::Vector3d(0.2, 0.6, 1), Eigen::Vector3d(0.5, 0.5, 1));
  EXPECT_NEAR(s.weights(0), (2 * 0.04 + 2 * 0.36 + 1) / (2 * 0.2 + 2 * 0.6 + 1), 1e-15);
  // ... and where none is finite, all weigh the same
  s.oldest = 0;
  s.fitness = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  LShade::remember(s, Eigen::Vector3d(9, 1, 5), Eigen::Vector3d(0.2, 0.6, 1), Eigen::Vector3d(0.5, 0.5, 1));
  EXPECT_NEAR(s.weights(0), (0.04 + 0.36 + 1) / 1.8, 1e-15);
}

// Every generation: the population of the linear schedule, an archive no larger than its share and only of points once
// held, the best never lost; in the end exactly the evaluations of the schedule.
TEST(LShade, ArchivesTheParentsThatLost) {
  LShade::State s;
  s.positions = Eigen::RowVector3d(10, 20, 30);
  s.fitness = Eigen::Vector3d(3, 3, 3);
  s.archive.resize(1, 0);
  const LShade shade{.archive_rate = 1.0 / 3};                              // room for one
  shade.replace(s, Eigen::RowVector3d(1, 2, 3), Eigen::Vector3d(2, 3, 4));  // better, as good, worse
  EXPECT_EQ(s.positions, Eigen::RowVector3d(1, 2, 30));
  EXPECT_EQ(s.fitness, Eigen::Vector3d(2, 3, 3));
  ASSERT_EQ(s.archive.cols(), 1);
  EXPECT_EQ(s.archive(0), 10);
  shade.replace(s, Eigen::RowVector3d(5, 6, 7), Eigen::Vector3d(9, 9, 1));
  ASSERT_EQ(s.archive.cols(), 1);
  EXPECT_EQ(s.archive(0), 30);  // the archive was full: the new loser takes the place
  EXPECT_EQ(s.positions, Eigen::RowVector3d(1, 2, 7));
}

TEST(LShade, ShrinksAndSpendsItsBudget) {
  for (const Index budget : {1000, 1003, 5001}) {
    const LShade shade{.max_evaluations = budget};
    const Box box = Box::cube(5, -3, 4);
    Index evaluated = 0, largest_archive = 0;
    std::set<std::vector<double>> held;
    const auto evaluate = [&](const MatrixX& population, VectorX& fitness) {
      evaluated += population.cols();
      for (Index k = 0; k < population.cols(); ++k)
        held.insert(std::vector<double>(population.col(k).begin(), population.col(k).end()));
      evaluate_bowl(population, fitness);
    };
    LShade::State s = shade.start(box, 1, evaluate);
    EXPECT_EQ(evaluated, 90);
    while (!shade.done(s)) {
      shade.step(s, box, evaluate);
      ASSERT_EQ(s.evaluations, evaluated);
      ASSERT_EQ(s.positions.cols(),
                std::lround(90 - 86.0 * static_cast<double>(evaluated) / static_cast<double>(budget)));
      ASSERT_LE(s.archive.cols(), std::lround(2.6 * static_cast<double>(s.positions.cols())));
      for (Index k = 0; k < s.archive.cols(); ++k)
        ASSERT_TRUE(held.contains(std::vector<double>(s.archive.col(k).begin(), s.archive.col(k).end())));
      ASSERT_EQ(s.fitness.minCoeff(), s.best_fitness);
      largest_archive = std::max(largest_archive, s.archive.cols());
    }
    EXPECT_EQ(evaluated, budget);
    EXPECT_EQ(s.positions.cols(), 4);
    EXPECT_GT(largest_archive, 90);
  }
}

// On a bowl of steep and flat axes success comes with large CR: what is remembered moves there.
TEST(LShade, LearnsItsConstants) {
  const auto evaluate = [](const MatrixX& population, VectorX& fitness) {
    fitness = population.colwise().sum().array().square().transpose() * 1e4;
    fitness += population.colwise().squaredNorm().transpose();
  };
  const LShade shade{.max_evaluations = 8000};
  double rates = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    LShade::State s = shade.start(Box::cube(6, -3, 4), seed, evaluate);
    while (!shade.done(s)) shade.step(s, Box::cube(6, -3, 4), evaluate);
    EXPECT_LT(s.best_fitness, 1e-6);
    rates += s.crossover_rates.mean() / 5;
  }
  EXPECT_GT(rates, 0.7);
}

// What was loaded is checked: each member of another size, and an index that points nowhere.
TEST(LShade, InconsistentStatesAreSeen) {
  const LShade::State made = LShade{.individuals_per_dimension = 5}.start(Box::cube(2, 0, 1), 1, evaluate_bowl);
  EXPECT_TRUE(made.consistent());
  const auto sound = [&](const auto& change) {
    LShade::State s = made;
    change(s);
    return s.consistent();
  };
  using State = LShade::State;
  EXPECT_FALSE(sound([](State& s) { s.best = VectorX::Zero(3); }));
  EXPECT_FALSE(sound([](State& s) { s.fitness = VectorX::Zero(9); }));
  EXPECT_FALSE(sound([](State& s) { s.positions = MatrixX::Zero(3, 10); }));
  EXPECT_FALSE(sound([](State& s) { s.archive = MatrixX::Zero(3, 1); }));
  EXPECT_TRUE(sound([](State& s) { s.archive = MatrixX::Zero(2, 7); }));
  EXPECT_FALSE(sound([](State& s) { s.weights = s.crossover_rates = VectorX(); }));
  EXPECT_FALSE(sound([](State& s) { s.crossover_rates = VectorX::Zero(5); }));
  EXPECT_TRUE(sound([](State& s) { s.weights = s.crossover_rates = VectorX::Ones(1); }));
  EXPECT_FALSE(sound([](State& s) { s.oldest = -1; }));
  EXPECT_TRUE(sound([](State& s) { s.oldest = 5; }));
  EXPECT_FALSE(sound([](State& s) { s.oldest = 6; }));
  for (const Index individuals : {3, 4})
    EXPECT_EQ(sound([&](State& s) {
                s.positions = MatrixX::Zero(2, individuals);
                s.fitness = VectorX::Zero(individuals);
              }),
              individuals == 4);
}

}  // namespace
}  // namespace vernier::differential_evolution_test
