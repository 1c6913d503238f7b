// SPDX-License-Identifier: BSD-3-Clause
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

VectorX errors(const std::vector<double>& values) {
  return Eigen::Map<const VectorX>(values.data(), static_cast<Index>(values.size()));
}

// Excess: (0.5, 0), mean 0.25, standard error 0.25; (0.5, 0.0625), mean 0.28125, standard error 0.21875.
TEST(PredictsWorse, WhatMakesErrorsLargerByMoreThanAStandardError) {
  EXPECT_FALSE(predicts_worse(errors({1.5, 1}), errors({1, 1})));
  EXPECT_TRUE(predicts_worse(errors({1.5, 1.0625}), errors({1, 1})));
  EXPECT_FALSE(predicts_worse(errors({1, 1}), errors({1.5, 1.0625})));
  EXPECT_FALSE(predicts_worse(errors({1, 1}), errors({1, 1})));
}

TEST(PredictsWorse, WhatIsNotFinite) {
  EXPECT_TRUE(predicts_worse(errors({nan, 1}), errors({2, 2.1})));
  EXPECT_TRUE(predicts_worse(errors({infinity, 1}), errors({2, 2.1})));
  EXPECT_TRUE(predicts_worse(errors({1, 1}), errors({infinity, infinity})));
}

}  // namespace
}  // namespace vernier::prior_choice_test
