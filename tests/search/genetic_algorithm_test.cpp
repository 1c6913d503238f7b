// SPDX-License-Identifier: BSD-3-Clause
// Encoding, crossover, mutation, selection and elitism, each by itself.

#include "vernier/search/genetic_algorithm.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numeric>
#include <string>

namespace vernier::genetic_algorithm_test {
namespace {

using Codes = GeneticAlgorithm::Codes;

const auto evaluate_sum = [](const MatrixX& population, VectorX& fitness) {
  fitness = population.colwise().sum().transpose();
};

// 4 bits: 15 steps between the bounds; 0 and all ones are the bounds, to the bit.
TEST(GeneticAlgorithm, DecodesByHand) {
  const GeneticAlgorithm ga{.bits = 4};
  Codes codes(2, 3);
  codes << 0, 5, 15, 15, 3, 0;
  const Box box{Eigen::Vector2d(-1, 0.1), Eigen::Vector2d(2, 0.7)};
  const MatrixX x = ga.decode(codes, box);
  EXPECT_EQ(x(0, 0), -1);
  EXPECT_DOUBLE_EQ(x(0, 1), 0);
  EXPECT_EQ(x(0, 2), 2);
  EXPECT_EQ(x(1, 0), 0.7);
  EXPECT_DOUBLE_EQ(x(1, 1), 0.1 + 0.6 * 0.2);
  EXPECT_EQ(x(1, 2), 0.1);
}

TEST(GeneticAlgorithm, EveryCodeLiesInTheBox) {
  for (const int bits : {1, 7, 10, 16}) {
    const GeneticAlgorithm ga{.bits = bits};
    const Index n = Index{1} << bits;
    Codes codes(1, n);
    for (Index k = 0; k < n; ++k) codes(0, k) = static_cast<std::uint16_t>(k);
    for (const auto& [lower, upper] : {std::pair{-1.0, 1.0}, {0.1, 0.3}, {-1e-7, 1e5}}) {
      const MatrixX x = ga.decode(codes, Box::cube(1, lower, upper));
      EXPECT_EQ(x(0, 0), lower);
      EXPECT_EQ(x(0, n - 1), upper);
      for (Index k = 1; k < n; ++k) ASSERT_GT(x(0, k), x(0, k - 1));
    }
  }
}

// Chromosomes of 3 variables of 4 bits, written out, cut at every place: what is behind the cut changes sides.
TEST(GeneticAlgorithm, CrossesByHand) {
  const GeneticAlgorithm ga{.bits = 4};
  const std::string a = "110000101011", b = "001111011001";
  const auto code = [](const std::string& bits, std::size_t variable) {
    return static_cast<std::uint16_t>(std::stoi(bits.substr(4 * variable, 4), nullptr, 2));
  };
  for (std::size_t cut = 0; cut < 12; ++cut) {
    Codes codes(3, 4);
    codes.setConstant(9);
    for (std::size_t i = 0; i < 3; ++i) {
      codes(static_cast<Index>(i), 1) = code(a, i);
      codes(static_cast<Index>(i), 2) = code(b, i);
    }
    ga.cross(codes, 1, static_cast<Index>(cut));
    const std::string child = a.substr(0, cut) + b.substr(cut), other = b.substr(0, cut) + a.substr(cut);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(codes(static_cast<Index>(i), 1), code(child, i)) << cut;
      EXPECT_EQ(codes(static_cast<Index>(i), 2), code(other, i)) << cut;
      EXPECT_EQ(codes(static_cast<Index>(i), 0), 9);
      EXPECT_EQ(codes(static_cast<Index>(i), 3), 9);
    }
  }
}

/// A state whose individuals all carry the same codes, so that only mutation makes a difference.
GeneticAlgorithm::State uniform_state(const GeneticAlgorithm& ga, Index dimension, std::uint16_t code,
                                      std::uint64_t seed) {
  GeneticAlgorithm::State s;
  s.codes = Codes::Constant(dimension, ga.individuals, code);
  s.fitness = VectorX::Zero(ga.individuals);
  s.best = VectorX::Zero(dimension);
  s.rng = Rng(seed);
  return s;
}

// 0.01 per bit: of 50 x 40 x 10 = 20,000 bits, 30 times from equal parents, flips are binomial
// with mean 6,000 and standard deviation 77; every bit of a code takes its share (600, sd 24.4); 1 - 0.99^10 = 9.6 % of
// the variables change.
TEST(GeneticAlgorithm, MutatesEachBitAtItsRate) {
  const GeneticAlgorithm ga{.individuals = 40, .generations = 1, .mutation_probability = 0.01, .elites = 0};
  const std::uint16_t parent = 0b1010011100;
  std::array<long, 16> by_bit{};
  long variables = 0, flips = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    GeneticAlgorithm::State s = uniform_state(ga, 50, parent, seed);
    ga.step(s, Box::cube(50, 0, 1), evaluate_sum);
    for (const std::uint16_t code : s.codes.reshaped()) {
      const unsigned changed = code ^ parent;
      variables += changed != 0 ? 1 : 0;
      for (unsigned bit = 0; bit < 16; ++bit) by_bit[bit] += (changed >> bit) & 1u;
    }
  }
  for (unsigned bit = 0; bit < 10; ++bit) {
    EXPECT_NEAR(static_cast<double>(by_bit[bit]), 600, 4 * 24.4) << bit;
    flips += by_bit[bit];
  }
  for (unsigned bit = 10; bit < 16; ++bit) EXPECT_EQ(by_bit[bit], 0) << bit;
  EXPECT_NEAR(static_cast<double>(flips), 6000, 4 * 77);
  EXPECT_NEAR(static_cast<double>(variables) / 60000, 1 - std::pow(0.99, 10), 4 * 0.0012);
}

TEST(GeneticAlgorithm, MutationAtItsEnds) {
  GeneticAlgorithm ga{.individuals = 5, .generations = 1, .mutation_probability = 0, .elites = 0};
  GeneticAlgorithm::State s = uniform_state(ga, 7, 0b1100110011, 1);
  ga.step(s, Box::cube(7, 0, 1), evaluate_sum);
  EXPECT_TRUE((s.codes.array() == 0b1100110011).all());
  ga.mutation_probability = 1;
  ga.step(s, Box::cube(7, 0, 1), evaluate_sum);
  EXPECT_TRUE((s.codes.array() == 0b0011001100).all());
}

/// Children of a population without mutation: columns k of one variable whose code is k, fitness k.
Codes children_of_ranks(const GeneticAlgorithm& ga, std::uint64_t seed) {
  GeneticAlgorithm::State s = uniform_state(ga, 1, 0, seed);
  for (Index k = 0; k < ga.individuals; ++k) {
    s.codes(0, k) = static_cast<std::uint16_t>(k);
    s.fitness(k) = static_cast<double>(k);
  }
  ga.step(s, Box::cube(1, 0, 1), evaluate_sum);
  return s.codes;
}

// With two drawn at random, the better one wins: rank r of n is a parent with probability (2 (n - r) - 1) / n^2, r = 0
// the best. Of 20 ranks the better half gets 3/4 of the children; 4 contestants: 15/16; one: half.
TEST(GeneticAlgorithm, TournamentsPreferTheBetter) {
  const std::pair<int, double> cases[] = {{1, 0.5}, {2, 0.75}, {4, 0.9375}};
  for (const auto& [contestants, expected] : cases) {
    const GeneticAlgorithm ga{.individuals = 20,
                              .generations = 1,
                              .crossover_probability = 0,
                              .mutation_probability = 0,
                              .tournament = contestants,
                              .elites = 0};
    long better_half = 0, total = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const Codes children = children_of_ranks(ga, seed);
      better_half += (children.array() < 10).count();
      total += children.size();
    }
    const double deviation = std::sqrt(expected * (1 - expected) / static_cast<double>(total));
    EXPECT_NEAR(static_cast<double>(better_half) / static_cast<double>(total), expected, 4 * deviation) << contestants;
  }
}

// Values 0 .. 19: rank k weighs 19 - k of 190 in all; the worst is never a parent, nor is what is not finite.
TEST(GeneticAlgorithm, RouletteTurnsInProportion) {
  VectorX fitness = VectorX::LinSpaced(21, 0, 20);
  fitness(20) = std::numeric_limits<double>::infinity();
  const ParentSelector parent(ParentSelection::roulette, 2, fitness);
  Rng rng(4);
  constexpr int draws = 100000;
  std::array<int, 21> hits{};
  for (int i = 0; i < draws; ++i) ++hits[static_cast<std::size_t>(parent(rng))];
  for (std::size_t k = 0; k < 20; ++k) {
    const double share = (19 - static_cast<double>(k)) / 190;
    EXPECT_NEAR(hits[k] / static_cast<double>(draws), share, 4 * std::sqrt(share * (1 - share) / draws)) << k;
  }
  EXPECT_EQ(hits[19] + hits[20], 0);
}

// Every bit of a pair comes from one parent, its opposite from the other, half of them each way and one as free as the
// other, also from those of another variable.
TEST(GeneticAlgorithm, UniformCrossoverMixesEveryBit) {
  const GeneticAlgorithm ga{.individuals = 100,
                            .generations = 1,
                            .crossover_probability = 1,
                            .mutation_probability = 0,
                            .tournament = 1,
                            .elites = 0,
                            .crossover = BitCrossover::uniform};
  std::array<int, 10> ones{};
  int pairs = 0, equal_neighbours = 0;
  std::array<int, 10> equal_variables{};
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    GeneticAlgorithm::State s = uniform_state(ga, 2, 0, seed);
    s.codes.rightCols(50).setConstant(0b1111111111);
    ga.step(s, Box::cube(2, 0, 1), evaluate_sum);
    for (Index k = 0; k < 100; k += 2) {
      const unsigned a = s.codes(0, k), b = s.codes(0, k + 1);
      if (a == b) continue;  // like parents
      ASSERT_EQ(a ^ b, 0b1111111111u);
      ++pairs;
      for (unsigned bit = 0; bit < 10; ++bit) ones[bit] += (a >> bit) & 1u;
      const unsigned c = s.codes(1, k);
      for (unsigned bit = 0; bit < 10; ++bit) equal_variables[bit] += ((a >> bit) & 1u) == ((c >> bit) & 1u);
      for (unsigned bit = 0; bit < 9; ++bit) equal_neighbours += ((a >> bit) & 1u) == ((a >> (bit + 1)) & 1u);
    }
  }
  ASSERT_GT(pairs, 2000);
  for (const int count : ones) EXPECT_NEAR(count, pairs / 2.0, 4 * std::sqrt(pairs / 4.0));
  EXPECT_NEAR(equal_neighbours, 9 * pairs / 2.0, 4 * std::sqrt(9 * pairs / 4.0));
  for (const int count : equal_variables) EXPECT_NEAR(count, pairs / 2.0, 4 * std::sqrt(pairs / 4.0));
}

// Parents 0000000000 and 1111111111 in equal parts: a pair of unlike parents, every second one, exchanges bits with the
// stated probability, and then a cut at 0 (1 of 10) changes nothing that can be seen.
TEST(GeneticAlgorithm, CrossesAtItsRate) {
  for (const double probability : {0.0, 0.6, 1.0}) {
    const GeneticAlgorithm ga{.individuals = 100,
                              .generations = 1,
                              .crossover_probability = probability,
                              .mutation_probability = 0,
                              .tournament = 1,
                              .elites = 0};
    long mixed = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      GeneticAlgorithm::State s = uniform_state(ga, 1, 0, seed);
      s.codes.rightCols(50).setConstant(0b1111111111);
      ga.step(s, Box::cube(1, 0, 1), evaluate_sum);
      mixed += (s.codes.array() != 0 && s.codes.array() != 0b1111111111).count();
    }
    // 5,000 pairs, both children mixed with probability p / 2 * 9 / 10
    const double share = probability * 0.45, deviation = std::sqrt(share * (1 - share) / 5000);
    EXPECT_NEAR(static_cast<double>(mixed) / 10000, share, 4 * deviation + 1e-12) << probability;
  }
}

// Whatever becomes of the others, the best stay as they are, and are not evaluated again.
TEST(GeneticAlgorithm, ElitesSurvive) {
  for (const int elites : {0, 1, 3}) {
    const GeneticAlgorithm ga{.individuals = 12, .generations = 20, .mutation_probability = 0.3, .elites = elites};
    const Box box = Box::cube(6, -1, 1);
    Index evaluated = 0;
    const auto evaluate = [&](const MatrixX& population, VectorX& fitness) {
      evaluated = population.cols();
      fitness = population.colwise().squaredNorm().transpose();
    };
    GeneticAlgorithm::State s = ga.start(box, 8, evaluate);
    EXPECT_EQ(evaluated, 12);
    bool ever_worse = false;
    while (!ga.done(s)) {
      std::vector<Index> order(12);
      std::iota(order.begin(), order.end(), Index{0});
      std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return s.fitness(a) < s.fitness(b); });
      const Codes before = s.codes;
      const VectorX values = s.fitness;
      ga.step(s, box, evaluate);
      EXPECT_EQ(evaluated, 12 - elites);
      for (int e = 0; e < elites; ++e) {
        EXPECT_EQ(s.codes.col(e), before.col(order[static_cast<std::size_t>(e)]));
        EXPECT_EQ(s.fitness(e), values(order[static_cast<std::size_t>(e)]));
      }
      EXPECT_LT((s.fitness - ga.decode(s.codes, box).colwise().squaredNorm().transpose()).cwiseAbs().maxCoeff(), 1e-15);
      ever_worse = ever_worse || s.fitness.minCoeff() > values.minCoeff();
    }
    EXPECT_EQ(ever_worse, elites == 0);  // at this rate of mutation only elitism keeps the best
  }
}

}  // namespace
}  // namespace vernier::genetic_algorithm_test
