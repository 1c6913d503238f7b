// SPDX-License-Identifier: BSD-3-Clause
// The score test: its figures by dense formulas, its error rates by simulation.

#include "vernier/least_squares/score_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "random_blocks.hpp"
#include "vernier/core/rng.hpp"

namespace score_test_test {
namespace {

using vernier::BlockSystem;
using vernier::Index;
using vernier::NormalEquations;
using vernier::Rng;
using vernier::ScoreTest;
using vernier::UnknownGroup;
using vernier::VectorX;
using vernier_test::RandomBlocks;
using vernier_test::RealMatrix;

const UnknownGroup group{5, 6, 7, 8, 9, 10, 11, 12, 13, 14};

ScoreTest tested(const RandomBlocks& blocks, double precision = 1, const std::vector<Index>& clusters = {}) {
  VectorX precisions = VectorX::Constant(15, 1e-3);
  for (const Index k : group) precisions(k) = precision;
  return blocks.with_system([&](const BlockSystem& system) {
    return score_test(system, NormalEquations(system), precisions, VectorX::Zero(15), group, clusters);
  });
}

/// Blocks whose residuals are noise, of another size for each block, and unknowns.
RandomBlocks noisy(Index n, std::uint64_t seed, double spread, double truth) {
  RandomBlocks out(n, 3);
  Rng rng(seed);
  VectorX unknowns = VectorX::Zero(15);
  for (const Index k : group) unknowns(k) = truth * rng.normal();
  for (Index b = 0; b < n; ++b) {
    const double size = std::exp(spread * rng.normal());
    auto& residual = out.rows[static_cast<std::size_t>(b)].residual;
    for (double& value : residual) value = size * rng.normal();
    residual -= out.expanded(b) * unknowns;
  }
  return out;
}

// Schur complement of the group in the dense normal equations, and the estimates of its unknowns by all rows.
TEST(ScoreTest, HasTheInformationAndTheEstimatesOfTheDenseProblem) {
  const RandomBlocks blocks = noisy(30, 1, 0, 0.3);
  RealMatrix matrix(15, 15), gradient(15, 1);
  for (Index b = 0; b < 30; ++b) {
    const RealMatrix rows = blocks.expanded(b);
    matrix += rows.transpose() * rows;
    gradient += rows.transpose() * blocks.row(b).residual;
  }
  for (Index k = 0; k < 5; ++k) matrix(k, k) += 1e-3;
  const RealMatrix others = matrix.block(0, 0, 5, 5), coupling = matrix.block(0, 5, 5, 10);
  const RealMatrix information = matrix.block(5, 5, 10, 10) - coupling.transpose() * others.inverse() * coupling;
  const RealMatrix all = matrix.inverse() * gradient;
  const ScoreTest found = tested(blocks);
  ASSERT_EQ(found.information.size(), 10);
  EXPECT_TRUE(std::is_sorted(found.information.begin(), found.information.end(), std::greater<>()));
  double trace = 0, squares = 0, wanted = 0;
  for (Index k = 0; k < 10; ++k) {
    trace += information(k, k);
    squares += found.information(k) * found.estimates(k) * found.estimates(k);
    for (Index j = 0; j < 10; ++j) wanted += all(5 + k, 0) * information(k, j) * all(5 + j, 0);
  }
  EXPECT_NEAR(found.information.sum(), trace, 1e-9 * trace);
  EXPECT_NEAR(squares, wanted, 1e-8 * wanted);
}

// The rate of p <= level in 400 draws: a binomial number.
double rate(double level, Index n, double spread, double truth, const std::vector<Index>& clusters = {}) {
  int below = 0;
  constexpr int draws = 400;
  for (int seed = 0; seed < draws; ++seed)
    below += tested(noisy(n, static_cast<std::uint64_t>(seed) + 10, spread, truth), 10, clusters).p <= level;
  return static_cast<double>(below) / draws;
}

TEST(ScoreTest, TakesEquationsThatAreFactorised) {
  const RandomBlocks blocks = noisy(30, 1, 0, 0.3);
  VectorX precisions = VectorX::Constant(15, 1e-3), held = precisions;
  for (const Index k : group) held(k) = vernier::suppressing_precision;
  const VectorX steps = VectorX::Zero(15);
  blocks.with_system([&](const BlockSystem& system) {
    const NormalEquations normal(system);
    const vernier::FactorisedEquations with(normal, precisions, steps), without(normal, held, steps);
    const ScoreTest found = score_test(system, with, without, precisions, steps, group),
                    usual = score_test(system, normal, precisions, steps, group);
    EXPECT_EQ(found.p, usual.p);
    EXPECT_EQ(found.noise, usual.noise);
    EXPECT_EQ(found.estimates, usual.estimates);
  });
}

// Three standard deviations above the level: 0.05 + 3 sqrt(0.05 0.95 / 400).
TEST(ScoreTest, FindsNothingWhereThereIsNothing) {
  EXPECT_LE(rate(0.05, 20, 0, 0), 0.083);
  EXPECT_LE(rate(0.05, 60, 0, 0), 0.083);
  EXPECT_GE(rate(0.05, 60, 0, 0), 0.017);
}

TEST(ScoreTest, FindsNothingInNoiseWhoseSizeVaries) { EXPECT_LE(rate(0.05, 60, 1, 0), 0.083); }

TEST(ScoreTest, FindsWhatIsThere) {
  EXPECT_GE(rate(0.005, 60, 0, 0.2), 0.95);
  EXPECT_GE(rate(0.005, 20, 0, 2), 0.9);  // a large effect is no noise
}

// Half of the unknowns move positions alone, the others what is no position, whose noise is half as large. Squares of
// estimates over their variances have a mean of 1, within 3.5 standard deviations of 400 and 600 of them. One variance
// for both would give 1.6 and 0.4.
TEST(ScoreTest, KnowsTheNoiseOfPositionsFromThatOfOtherValues) {
  double positions = 0, others = 0, of_positions = 0, of_others = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomBlocks blocks = noisy(40, seed, 0, 0);
    for (auto& rows : blocks.rows)
      for (Index r = 0; r < 6; ++r) {
        rows.factor(r, r < 3 ? 2 : 0) = 0;
        if (r >= 3) rows.residual(r) *= 0.5;
      }
    const ScoreTest found = tested(blocks, 1e-3);
    for (Index k = 0; k < found.estimates.size(); ++k) {
      double share = 0;
      for (Index j = 0; j < 4; ++j) share += found.directions(j, k) * found.directions(j, k);
      const double square = found.estimates(k) * found.estimates(k) / found.variances(k);
      positions += share * square;
      others += (1 - share) * square;
      of_positions += share;
      of_others += 1 - share;
    }
  }
  EXPECT_NEAR(of_positions, 400, 1e-6);
  EXPECT_NEAR(positions / of_positions, 1, 0.25);
  EXPECT_NEAR(others / of_others, 1, 0.2);
}

// All six values of a block show the same of the unknowns, so that few blocks have much to say of each. Scores of
// left-out residuals are larger than those of the noise then. The mean variance is that of 1,000 estimates, within four
// standard deviations.
TEST(ScoreTest, VariancesHoldIfFewBlocksSayMuch) {
  double squares = 0, variances = 0, by_flipped = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomBlocks blocks = noisy(25, seed, 0, 0);
    for (auto& rows : blocks.rows)
      for (Index r = 1; r < 6; ++r)
        for (Index c = 0; c < 3; ++c) rows.factor(r, c) = rows.factor(0, c);
    const ScoreTest found = tested(blocks, 1e-3);
    for (Index k = 0; k < 10; ++k) {
      squares += found.information(k) * found.estimates(k) * found.estimates(k);
      variances += found.information(k) * found.variances(k);
      by_flipped += found.noise;
    }
  }
  EXPECT_NEAR(variances / squares, 1, 0.18);
  EXPECT_GT(by_flipped / squares, 1.4);
}

// Ten equal readings of each of six poses are six pieces of evidence.
TEST(ScoreTest, ReadingsOfAPoseAreNoEvidenceOfTheirOwn) {
  std::vector<Index> clusters;
  for (Index b = 0; b < 60; ++b) clusters.push_back(b / 10);
  int alone = 0, together = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    RandomBlocks blocks = noisy(60, seed, 0, 0);
    for (Index b = 0; b < 60; ++b)
      blocks.rows[static_cast<std::size_t>(b)] = blocks.rows[static_cast<std::size_t>(b / 10 * 10)];
    alone += tested(blocks, 10).p <= 0.05;
    together += tested(blocks, 10, clusters).p <= 0.05;
  }
  EXPECT_GT(alone, 50);
  EXPECT_LE(together, 12);
}

TEST(ScoreTest, SaysNothingWithoutASolution) {
  RandomBlocks blocks = noisy(20, 1, 0, 0);
  blocks.rows[3].residual(1) = std::nan("");
  EXPECT_EQ(tested(blocks).p, 1);
  EXPECT_EQ(tested(blocks).information.size(), 0);
}

}  // namespace
}  // namespace score_test_test
