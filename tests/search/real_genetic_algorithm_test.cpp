// SPDX-License-Identifier: BSD-3-Clause
// Crossover and mutation of real numbers, by hand and by their distributions.

#include "vernier/search/real_genetic_algorithm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "vernier/core/argsort.hpp"

namespace vernier::real_genetic_algorithm_test {
namespace {

using Ga = RealGeneticAlgorithm;

const auto evaluate_sum = [](const MatrixX& population, VectorX& fitness) {
  fitness = population.colwise().sum().transpose();
};

// eta = 1, parents 2 and 4 in [0, 12], u = 0.32. Lower side: room 2, 2 - (1 + 2)^-2 = 17/9, u times that 0.6044 <= 1,
// beta = sqrt(0.6044) = 0.77746. Upper side: room 8, 2 - 9^-2 = 161/81, beta = sqrt(0.63605) = 0.79753.
// u = 0.8: lower 1.51111 > 1, beta = sqrt(1 / 0.48889) = 1.43019; upper beta = sqrt(1 / (2 - 1.590123)) = 1.56198.
TEST(RealGeneticAlgorithm, SimulatedBinaryCrossoverByHand) {
  const Ga ga{.crossover_index = 1};
  for (const auto& [a, b] : {std::pair{2.0, 4.0}, {4.0, 2.0}}) {
    const auto [c1, c2] = ga.simulated_binary(a, b, 0, 12, 0.32);
    EXPECT_NEAR(c1, 3 - std::sqrt(0.32 * 17 / 9), 1e-14);
    EXPECT_NEAR(c2, 3 + std::sqrt(0.32 * 161 / 81), 1e-14);
    const auto [d1, d2] = ga.simulated_binary(a, b, 0, 12, 0.8);
    EXPECT_NEAR(d1, 3 - 1.43019, 1e-5);
    EXPECT_NEAR(d2, 3 + 1.56198, 1e-5);
  }
  const auto [e1, e2] = ga.simulated_binary(5, 5, 0, 12, 0.9);
  EXPECT_EQ(e1, 5);
  EXPECT_EQ(e2, 5);
}

// The bounds are where u = 1 leads, none is passed before, and children far from both bounds have the parents' mean.
TEST(RealGeneticAlgorithm, SimulatedBinaryCrossoverEndsAtTheBounds) {
  for (const double eta : {0.0, 2.0, 15.0}) {
    const Ga ga{.crossover_index = eta};
    double low_before = 1e9, high_before = -1e9;
    for (int i = 0; i <= 1000; ++i) {
      const auto [low, high] = ga.simulated_binary(1, 2.5, 0.5, 4, i == 1000 ? 1 - 1e-15 : i / 1000.0);
      EXPECT_LE(low, low_before);
      EXPECT_GE(high, high_before);
      EXPECT_GE(low, 0.5);
      EXPECT_LE(high, 4);
      std::tie(low_before, high_before) = std::pair{low, high};
    }
    EXPECT_NEAR(low_before, 0.5, 1e-7);
    EXPECT_NEAR(high_before, 4, 1e-7);
  }
  const auto [low, high] = Ga{}.simulated_binary(1, 2.5, -1e9, 1e9, 0.7);
  EXPECT_NEAR(low + high, 3.5, 1e-12);
  // contracting and expanding are equally likely: beta = 1 at u = 1/2
  const auto [same_low, same_high] = Ga{}.simulated_binary(1, 2.5, -1e9, 1e9, 0.5);
  EXPECT_NEAR(same_low, 1, 1e-12);
  EXPECT_NEAR(same_high, 2.5, 1e-12);
}

// eta = 1, x = 3 in [0, 4]. u = 0.25: sqrt(0.5 + 0.5 (1/4)^2) - 1 = -0.27113; u = 0.75: 1 - sqrt(0.5 + 0.5 (3/4)^2) =
// 0.11612.
TEST(RealGeneticAlgorithm, PolynomialMutationByHand) {
  const Ga ga{.mutation_index = 1};
  EXPECT_NEAR(ga.polynomial(3, 0, 4, 0.25), 3 - 4 * 0.27113, 1e-4);
  EXPECT_NEAR(ga.polynomial(3, 0, 4, 0.75), 3 + 4 * 0.11612, 1e-4);
  EXPECT_NEAR(ga.polynomial(3, 0, 4, 0), 0, 1e-15);
  EXPECT_NEAR(ga.polynomial(3, 0, 4, 1 - 1e-16), 4, 1e-7);
  EXPECT_EQ(ga.polynomial(3, 0, 4, 0.5), 3);
  EXPECT_EQ(ga.polynomial(0, 0, 4, 0.3), 0);
  EXPECT_EQ(ga.polynomial(4, 0, 4, 0.9), 4);
  // far from the bounds and for a large eta the step is that of Deb's plain distribution: (2u)^(1/(eta+1)) - 1
  EXPECT_NEAR(Ga{}.polynomial(0.5, 0, 1, 0.1) - 0.5, std::pow(0.2, 1.0 / 21) - 1, 1e-7);
}

/// Children of 2 x 2 parents (1, 10) and (2, 30) in the box [0, 4] x [0, 100].
std::vector<MatrixX> children(const Ga& ga, int count) {
  Rng rng(3);
  std::vector<MatrixX> out;
  const Box box{Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 100)};
  for (int i = 0; i < count; ++i) {
    MatrixX pair(2, 2);
    pair << 1, 2, 10, 30;
    ga.cross(pair, 0, box, rng);
    out.push_back(pair);
  }
  return out;
}

// Coordinate 0: interval 1 wide, half as much on either side is [0.5, 2.5]; coordinate 1: [0, 40], of which alpha = 2
// would take [-30, 70] and the bound cuts.
TEST(RealGeneticAlgorithm, BlendIsUniformInTheWidenedInterval) {
  const auto moments = [](const Ga& ga, Index d) {
    double least = 1e9, greatest = -1e9, sum = 0, squares = 0;
    for (const MatrixX& pair : children(ga, 20000))
      for (Index k = 0; k < 2; ++k) {
        const double x = pair(d, k);
        least = std::min(least, x);
        greatest = std::max(greatest, x);
        sum += x / 40000;
        squares += x * x / 40000;
      }
    return std::array{least, greatest, sum, squares - sum * sum};
  };
  const auto [low, high, mean, variance] = moments({.crossover = RealCrossover::blx}, 0);
  EXPECT_GE(low, 0.5);
  EXPECT_LE(high, 2.5);
  EXPECT_NEAR(low, 0.5, 1e-3);
  EXPECT_NEAR(high, 2.5, 1e-3);
  EXPECT_NEAR(mean, 1.5, 0.012);
  EXPECT_NEAR(variance, 4.0 / 12, 0.006);
  const auto [cut, top, cut_mean, cut_variance] = moments({.crossover = RealCrossover::blx, .blend = 2}, 1);
  EXPECT_GE(cut, 0);
  EXPECT_NEAR(cut, 0, 0.02);
  EXPECT_NEAR(top, 70, 0.02);
  EXPECT_NEAR(cut_mean, 35, 0.42);
  EXPECT_NEAR(cut_variance, 4900.0 / 12, 7);
}

// One cut, before variable 0 or 1, in equal parts: (2, 30 | 1, 10) or (1, 30 | 2, 10). Uniform: all four, in equal
// parts.
TEST(RealGeneticAlgorithm, CutsAndExchanges) {
  for (const auto crossover : {RealCrossover::one_point, RealCrossover::uniform}) {
    std::array<int, 4> seen{};
    for (const MatrixX& pair : children({.crossover = crossover}, 8000)) {
      ASSERT_EQ(pair.row(0).sum(), 3);
      ASSERT_EQ(pair.row(1).sum(), 40);
      ASSERT_TRUE((pair.row(0).array() == 1).any() && (pair.row(1).array() == 10).any());
      ++seen[static_cast<std::size_t>((pair(0, 0) == 2 ? 2 : 0) + (pair(1, 0) == 30 ? 1 : 0))];
    }
    const bool one_point = crossover == RealCrossover::one_point;
    const std::array<int, 4> expected = one_point ? std::array{0, 4000, 0, 4000} : std::array{2000, 2000, 2000, 2000};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(seen[i], expected[i], expected[i] == 0 ? 0 : 180) << i;
  }
}

// SBX touches half of the variables, and each child is as often on one side as on the other.
TEST(RealGeneticAlgorithm, SbxCrossesHalfTheVariables) {
  int touched = 0, upper_first = 0;
  for (const MatrixX& pair : children({}, 8000)) {
    if (pair(0, 0) == 1 && pair(0, 1) == 2) continue;
    ++touched;
    upper_first += pair(0, 0) > pair(0, 1);
  }
  EXPECT_NEAR(touched, 4000, 180);
  EXPECT_NEAR(upper_first, touched / 2.0, 130);
}

/// Steps of all children of equal parents at the middle of the box [0, 2]^50.
VectorX steps(Ga ga) {
  ga.elites = 0;
  ga.survival = Survival::elites;
  ga.individuals = 40;
  std::vector<double> out;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Ga::State s;
    s.rng = Rng(seed);
    s.positions = MatrixX::Ones(50, 40);
    s.fitness = VectorX::Zero(40);
    s.best = VectorX::Ones(50);
    ga.step(s, Box::cube(50, 0, 2), evaluate_sum);
    for (const double x : s.positions.reshaped()) out.push_back(x - 1);
  }
  return Eigen::Map<VectorX>(out.data(), static_cast<Index>(out.size()));
}

// Two of 50 variables mutate in a child: 4,000 of 100,000; normal steps of 0.05 widths.
TEST(RealGeneticAlgorithm, MutatesAtItsRateAndSize) {
  for (const auto mutation : {RealMutation::gaussian, RealMutation::polynomial}) {
    const VectorX moved = steps({.mutations = 2, .mutation = mutation});
    const auto count = static_cast<double>((moved.array() != 0).count());
    EXPECT_NEAR(count, 4000, 4 * 62);
    EXPECT_NEAR(moved.sum() / count, 0, 4 * 0.1 / std::sqrt(count));
    if (mutation == RealMutation::gaussian) {
      EXPECT_NEAR(moved.squaredNorm() / count, 0.1 * 0.1, 4 * 0.01 * std::sqrt(2 / count));
    }
  }
  EXPECT_EQ(steps({.mutations = 0}).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ((steps({.mutations = 500}).array() == 0).count(), 0);
}

// With truncation no value of a place in the ranking ever rises. With elites alone those behind them do, and the elites
// stay as they are and are not evaluated again.
TEST(RealGeneticAlgorithm, WhoSurvives) {
  for (const auto survival : {Survival::elites, Survival::best_of_both}) {
    const Ga ga{.individuals = 12, .generations = 30, .mutations = 6, .elites = 3, .survival = survival};
    const Box box = Box::cube(6, -1, 1);
    Index evaluated = 0;
    const auto evaluate = [&](const MatrixX& population, VectorX& fitness) {
      evaluated = population.cols();
      fitness = population.colwise().squaredNorm().transpose();
    };
    Ga::State s = ga.start(box, 8, evaluate);
    bool rises = false;
    while (!ga.done(s)) {
      const MatrixX positions = s.positions;
      const std::vector<Index> order = argsort(s.fitness);
      VectorX before = s.fitness;
      ga.step(s, box, evaluate);
      EXPECT_EQ(evaluated, survival == Survival::elites ? 9 : 12);
      for (Index e = 0; survival == Survival::elites && e < 3; ++e)
        EXPECT_EQ(s.positions.col(e), positions.col(order[static_cast<std::size_t>(e)]));
      VectorX after = s.fitness;
      std::sort(before.begin(), before.end());
      std::sort(after.begin(), after.end());
      rises = rises || (after.array() > before.array()).any();
      EXPECT_LT((s.fitness - s.positions.colwise().squaredNorm().transpose()).cwiseAbs().maxCoeff(), 1e-15);
    }
    EXPECT_EQ(rises, survival == Survival::elites);
  }
}

}  // namespace
}  // namespace vernier::real_genetic_algorithm_test
