// The scale of a prior by leave-one-block-out errors.

#include "vernier/least_squares/prior_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "random_blocks.hpp"

namespace vernier::prior_choice_test {
namespace {

using namespace vernier_test;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Trials in order of precision.
std::vector<PriorTrial> trials(const std::vector<std::vector<double>>& errors) {
  std::vector<PriorTrial> out;
  double precision = 1;
  for (const auto& of_trial : errors) {
    out.push_back({precision, Eigen::Map<const VectorX>(of_trial.data(), static_cast<Index>(of_trial.size()))});
    precision *= 10;
  }
  return out;
}

TEST(OneStandardErrorRule, ByHand) {
  // two blocks, excess (0.5, 0): mean 0.25, standard error sqrt(0.125 / (2 * 1)) = 0.25, all exact in binary: allowed
  EXPECT_EQ(one_standard_error_rule(trials({{1, 1}, {1.5, 1}})), 1u);
  EXPECT_EQ(one_standard_error_rule(trials({{1, 1}, {1.5, 1.0625}})), 0u);
  // four blocks, excess (0.2, 0, 0.2, 0): mean 0.1; standard error 0.058, standard deviation 0.115
  EXPECT_EQ(one_standard_error_rule(trials({{1, 1, 1, 1}, {1.2, 1, 1.2, 1}})), 0u);
  // excess (0.3, -0.1, 0.1, -0.1): mean 0.05, standard error 0.096
  EXPECT_EQ(one_standard_error_rule(trials({{1, 1, 1, 1}, {1.3, 0.9, 1.1, 0.9}})), 1u);
  // errors differ by blocks much more than by trials: only paired differences say that the second trial is worse
  EXPECT_EQ(one_standard_error_rule(trials({{1, 9, 4, 20}, {1.5, 9.5, 4.5, 20.5}})), 0u);
  // a trial that is much better in all blocks but one is the best; the other exceeds it by 6, standard error 1
  EXPECT_EQ(one_standard_error_rule(trials({{1, 1, 1, 1, 1, 1, 1, 9}, {8, 8, 8, 8, 8, 8, 8, 8}})), 0u);
}

TEST(OneStandardErrorRule, TakesTheTightestOfThoseAllowed) {
  const std::vector<double> best{1, 1, 1}, allowed{1.3, 0.9, 0.9}, worse{2, 2, 2.01};
  EXPECT_EQ(one_standard_error_rule(trials({best, allowed, allowed})), 2u);
  EXPECT_EQ(one_standard_error_rule(trials({best, allowed, worse})), 1u);
  EXPECT_EQ(one_standard_error_rule(trials({worse, best, worse})), 1u);
  EXPECT_EQ(one_standard_error_rule(trials({best, worse, allowed})), 2u);
  EXPECT_EQ(one_standard_error_rule(trials({worse})), 0u);
}

TEST(OneStandardErrorRule, WhatIsNotFiniteIsSuppressed) {
  EXPECT_EQ(one_standard_error_rule(trials({{nan, 1}, {nan, 1}, {nan, 1}})), 2u);
  EXPECT_EQ(one_standard_error_rule(trials({{infinity, 1}, {1, 1}})), 1u);
  EXPECT_THROW((void)one_standard_error_rule({}), std::invalid_argument);
}

/// Blocks with given errors along x, and log predictive densities.
LeftOutBlocks left_out(const std::vector<double>& errors, const std::vector<double>& log_densities) {
  const auto n = static_cast<Index>(errors.size());
  LeftOutBlocks out{Eigen::Matrix3Xd::Zero(3, n), Eigen::Map<const VectorX>(log_densities.data(), n)};
  for (Index b = 0; b < n; ++b) out.errors(0, b) = -errors[static_cast<std::size_t>(b)];
  return out;
}

// Saved: (0.5, 0), mean 0.25, standard error 0.25; (0.5625, 0), mean 0.28125, standard error 0.28125; (0.5, 0.0625):
// mean 0.28125, standard error 0.21875.
TEST(ErrorsSupport, WhatMakesThemSmallerByMoreThanAStandardError) {
  const std::vector<double> same{0, 0};
  EXPECT_FALSE(errors_support(left_out({1, 1}, same), left_out({1.5, 1}, same)));
  EXPECT_FALSE(errors_support(left_out({1, 1}, same), left_out({1.5625, 1}, same)));
  EXPECT_TRUE(errors_support(left_out({1, 1}, same), left_out({1.5, 1.0625}, same)));
  EXPECT_FALSE(errors_support(left_out({1.5, 1.0625}, same), left_out({1, 1}, same)));
  EXPECT_TRUE(errors_support(left_out({1, 1}, {-9, -9}), left_out({1.5, 1.0625}, same)));  // whatever the densities
}

// Errors smaller by 0.125, standard error 0.375.
TEST(DensitiesSupport, WhatMakesThemGreaterByMoreThanAStandardErrorAndErrorsSmaller) {
  const std::vector<double> with{1, 1}, without{1.5, 0.75}, zero{0, 0};
  EXPECT_FALSE(errors_support(left_out(with, {9, 9}), left_out(without, zero)));
  EXPECT_FALSE(densities_support(left_out(with, zero), left_out(without, zero)));
  EXPECT_FALSE(densities_support(left_out(with, {0.5, 0}), left_out(without, zero)));
  EXPECT_TRUE(densities_support(left_out(with, {0.5, 0.0625}), left_out(without, zero)));
  EXPECT_FALSE(densities_support(left_out(with, zero), left_out(without, {0.5, 0.0625})));
  EXPECT_FALSE(densities_support(left_out(without, {9, 9}), left_out(with, zero)));  // errors greater by 0.125
  EXPECT_FALSE(densities_support(left_out(with, {9, 9}), left_out(with, zero)));     // the same errors
}

TEST(ErrorsSupport, NothingThatIsNotFinite) {
  const std::vector<double> zero{0, 0}, none{-infinity, -infinity};
  const auto both = [](const LeftOutBlocks& a, const LeftOutBlocks& b) {
    return errors_support(a, b) || densities_support(a, b);
  };
  EXPECT_FALSE(both(left_out({nan, 1}, zero), left_out({2, 2.1}, zero)));
  EXPECT_FALSE(both(left_out({infinity, infinity}, none), left_out({2, 2.1}, zero)));
  EXPECT_FALSE(both(left_out({1, 1}, zero), left_out({infinity, infinity}, none)));
  EXPECT_FALSE(both(left_out({1, 1}, {nan, nan}), left_out({1.5, 0.75}, zero)));
}

PriorChoice chosen(const RandomBlocks& poses) {
  return poses.with_system([&](const BlockSystem& s) {
    return choose_prior(s, NormalEquations(s), VectorX::Constant(15, 1e-3), VectorX::Zero(15), 5, 10, 1);
  });
}

// Unknowns from ten expected sizes down to a hundredth: the error under each prior that is tried, by solving without
// each block in turn.
TEST(ChoosePrior, TriesPriorsOfAllSizes) {
  for (const double size : {10.0, 1.0, 0.1, 0.01})
    for (const std::uint64_t seed : {1u, 2u, 3u, 7u}) {  // the last is best under 1e4 where unknowns are the smallest
      RandomBlocks poses(24, seed);
      Rng rng(seed + 10);
      const VectorX truth = random_vector(rng, 15, size);
      for (Index b = 0; b < 24; ++b) poses.rows[static_cast<std::size_t>(b)].residual -= poses.expanded(b) * truth;
      const VectorX steps = VectorX::Constant(15, 0.02);
      std::vector<PriorTrial> wanted;
      double smallest = infinity;
      for (const double precision : {0.3, 1.0, 3.0, 10.0, 100.0, 1e4, 1e12}) {
        VectorX precisions = VectorX::Constant(15, 1e-3);
        for (Index k = 5; k < 15; ++k) precisions(k) = precision;
        VectorX errors(12);
        for (Index b = 0; b < 12; ++b) errors(b) = left_out_by_force(poses, precisions, steps, 2 * b).norm();
        smallest = std::min(smallest, errors.mean());
        wanted.push_back({precision, errors});
      }
      const PriorChoice choice = poses.with_system([&](const BlockSystem& s) {
        return choose_prior(s, NormalEquations(s), VectorX::Constant(15, 1e-3), steps, 5, 10, 2);
      });
      const PriorTrial& best = wanted[one_standard_error_rule(wanted)];
      EXPECT_EQ(choice.precision, best.precision) << size;
      EXPECT_NEAR(choice.chosen_error, best.errors.mean(), 1e-6 * smallest) << size;
      EXPECT_NEAR(choice.smallest_error, smallest, 1e-6 * smallest) << size;
      EXPECT_NEAR(choice.suppressed_error, wanted.back().errors.mean(), 1e-6 * smallest) << size;
    }
}

TEST(ChoosePrior, SurvivesRowsThatAreNotFinite) {
  for (const double bad : {nan, infinity, -infinity})
    for (const int part : {0, 1, 2, 3}) {
      RandomBlocks poses(15, 10);
      RowBlock& p = poses.rows[6];
      if (part == 0) p.residual(1) = bad;
      if (part == 1) p.dense(2, 3) = bad;
      if (part == 2) p.factor(0, 2) = bad;
      if (part == 3) p.functions(0) = bad;
      EXPECT_EQ(chosen(poses).precision, suppressing_precision) << bad << " in part " << part;
    }
}

}  // namespace
}  // namespace vernier::prior_choice_test
