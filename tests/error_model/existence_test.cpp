// SPDX-License-Identifier: BSD-3-Clause
// Three answers, from scores made by hand.

#include "vernier/error_model/existence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "vernier/core/rng.hpp"

namespace existence_test {
namespace {

using vernier::Answer;
using vernier::Existence;
using vernier::Index;
using vernier::MatrixX;
using vernier::Rng;
using vernier::ScoreTest;
using vernier::VectorX;

/// m directions of equal information; a coefficient of one moves the tool by 1 mm.
ScoreTest scores(Index m, double information, double p, const VectorX& estimates) {
  ScoreTest out{.p = p, .information = VectorX::Constant(m, information), .estimates = estimates, .tested = {}};
  out.variances = VectorX::Constant(m, 1 / information);
  out.displacement = 1e-6 * MatrixX::Identity(m, m);
  out.directions = MatrixX::Identity(m, m);
  return out;
}

TEST(Existence, IsFoundRuledOutOrUndecided) {
  const VectorX large = VectorX::Constant(4, 0.5), none = VectorX::Zero(4);
  const Existence found = existence(scores(4, 1e4, 1e-3, large), 0.005, 0.1e-3, 50);
  EXPECT_EQ(found.answer, Answer::found);
  EXPECT_NEAR(found.size, 1e-3, 0.02e-3);  // root of four times 0.5 mm squared
  EXPECT_LT(found.interval[0], 1e-3);
  EXPECT_GT(found.interval[1], 1e-3);
  EXPECT_EQ(existence(scores(4, 1e4, 0.5, none), 0.005, 0.1e-3, 50).answer, Answer::ruled_out);
  const Existence undecided = existence(scores(4, 1e2, 0.5, none), 0.005, 0.1e-3, 50);
  EXPECT_EQ(undecided.answer, Answer::undecided);
  EXPECT_EQ(undecided.interval[0], 0);
  EXPECT_GT(undecided.interval[1], 0.1e-3);
  EXPECT_GT(undecided.poses, 50);
  EXPECT_EQ(existence(ScoreTest{}, 0.005, 0.1e-3, 50).answer, Answer::untested);
}

// The size of effects drawn with coefficients of 0.3: the interval holds it in 95 % of 1,000 draws, within three
// standard deviations of that rate.
TEST(Existence, ItsIntervalHoldsTheSize) {
  Rng rng(4);
  int held = 0;
  for (int draw = 0; draw < 1000; ++draw) {
    VectorX truth(6), estimates(6);
    for (Index k = 0; k < 6; ++k) {
      truth(k) = 0.3 * rng.normal();
      estimates(k) = truth(k) + 0.1 * rng.normal();
    }
    const Existence found = existence(scores(6, 100, 0.001, estimates), 0.005, 0.1e-3, 50);
    held += found.interval[0] <= 1e-3 * truth.norm() && 1e-3 * truth.norm() <= found.interval[1];
  }
  EXPECT_GE(held, 930);
  EXPECT_LE(held, 971);
}

// Sizes of 60 harmonics in 200 draws, of which three orders are there, as large as their noise: with spectra that may
// fall the interval holds the size in 95 %, within three standard deviations. It is narrower than with all orders
// alike.
TEST(Existence, SpectraThatFallAreToldFromNoise) {
  constexpr Index m = 60;
  VectorX falling(m), steep(m);
  for (Index k = 0; k < m; ++k) {
    falling(k) = 1.0 / static_cast<double>(1 + k / 2);
    steep(k) = falling(k) * falling(k);
  }
  Rng rng(5);
  int held = 0;
  double width = 0, width_of_flat = 0;
  for (int draw = 0; draw < 200; ++draw) {
    VectorX estimates(m);
    double square = 0;
    for (Index k = 0; k < m; ++k) {
      const double truth = k < 6 ? 0.2 * rng.normal() : 0;
      estimates(k) = truth + 0.1 * rng.normal();
      square += truth * truth;
    }
    const double size = 1e-3 * std::sqrt(square);
    const ScoreTest score = scores(m, 100, 0.001, estimates);
    const Existence found = existence(score, 0.005, 0.1e-3, 50, {falling, steep}),
                    flat = existence(score, 0.005, 0.1e-3, 50);
    held += found.interval[0] <= size && size <= found.interval[1];
    width += found.interval[1] - found.interval[0];
    width_of_flat += flat.interval[1] - flat.interval[0];
  }
  EXPECT_GE(held, 181);
  EXPECT_LT(width, 0.8 * width_of_flat);
}

// Variances that are four times the true ones: 60 directions of which the data tell unequally much show it.
TEST(Existence, ManyEstimatesTellTheScaleOfTheNoise) {
  constexpr Index m = 60;
  Rng rng(6);
  int held = 0;
  for (int draw = 0; draw < 200; ++draw) {
    ScoreTest score = scores(m, 100, 0.001, VectorX::Zero(m));
    double square = 0;
    for (Index k = 0; k < m; ++k) {
      const double std = 0.03 * std::pow(1.08, static_cast<double>(k)), truth = 0.2 * rng.normal();
      score.information(k) = 1 / (std * std);
      score.variances(k) = 4 * std * std;
      score.estimates(k) = truth + std * rng.normal();
      square += truth * truth;
    }
    const Existence found = existence(score, 0.005, 0.1e-3, 50);
    held += found.interval[0] <= 1e-3 * std::sqrt(square) && 1e-3 * std::sqrt(square) <= found.interval[1];
  }
  EXPECT_GE(held, 181);
}

// The share of simulated scores above their 99.5 % quantile without the effect, with as many poses as it asks for.
TEST(Existence, FindsFourOfFiveEffectsWithThatManyPoses) {
  const Existence undecided = existence(scores(6, 50, 0.5, VectorX::Zero(6)), 0.005, 0.2e-3, 100);
  ASSERT_GT(undecided.poses, 0);
  const double information = 50 * static_cast<double>(undecided.poses) / 100;
  const double coefficient = 0.2 / std::sqrt(6);  // six of them move the tool by 0.2 mm
  Rng rng(7);
  constexpr double quantile = 18.548;  // of a chi-square of 6 degrees of freedom, 99.5 %
  int found = 0;
  for (int draw = 0; draw < 2000; ++draw) {
    double square = 0;
    for (int k = 0; k < 6; ++k) {
      const double score = std::sqrt(information) * coefficient + rng.normal();
      square += score * score;
    }
    found += square > quantile;
  }
  EXPECT_NEAR(found / 2000.0, 0.8, 0.04);
}

}  // namespace
}  // namespace existence_test
