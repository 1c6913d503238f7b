// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/identification/identifiable_parameters.hpp"

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"
#include "vernier/identification/options.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::identifiable_parameters_test {
namespace {

MatrixX random_matrix(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, columns);
  for (auto& x : out.reshaped()) x = rng.normal();
  return out;
}

TEST(IdentifiableParameters, KeepsTheFirstOfDependentOnesAndNamesWhatAbsorbsTheRest) {
  MatrixX j = random_matrix(30, 6, 1);
  j.col(3) = 2 * j.col(0) - j.col(2);
  j.col(4).setZero();
  const IdentifiableParameters columns(j);
  EXPECT_EQ(columns.base, (std::vector<Index>{0, 1, 2, 5}));
  ASSERT_EQ(columns.dependent.size(), 2u);
  EXPECT_EQ(columns.dependent[0].column, 3);
  EXPECT_EQ(columns.dependent[0].absorbed_by, (std::vector<Index>{0, 2}));
  EXPECT_EQ(columns.dependent[1].column, 4);
  EXPECT_TRUE(columns.dependent[1].absorbed_by.empty());
}

// A column of a thousand-millionth of the largest still counts as an effect; parameters that absorb less than a
// twentieth of another are not named.
TEST(IdentifiableParameters, LimitsOfEffectAndOfShares) {
  MatrixX j = random_matrix(30, 6, 3);
  j.col(1) *= 1e-7;
  j.col(2) *= 1e-11;
  j.col(5) = j.col(0) - 0.07 * j.col(3) + 0.03 * j.col(4) + 30 * j.col(1);
  const IdentifiableParameters columns(j);
  EXPECT_EQ(columns.base, (std::vector<Index>{0, 1, 3, 4}));
  ASSERT_EQ(columns.dependent.size(), 2u);
  EXPECT_EQ(columns.dependent[0].column, 2);
  EXPECT_TRUE(columns.dependent[0].absorbed_by.empty());
  EXPECT_EQ(columns.dependent[1].column, 5);
  EXPECT_EQ(columns.dependent[1].absorbed_by, std::vector<Index>{1});  // a step thirty times as large as the next
  j.col(5) = j.col(0) - 0.07 * j.col(3) + 0.03 * j.col(4);
  EXPECT_EQ(IdentifiableParameters(j).dependent[1].absorbed_by, (std::vector<Index>{0, 3}));
}

TEST(IdentifiableParameters, MoreColumnsThanRows) {
  EXPECT_EQ(IdentifiableParameters(random_matrix(4, 9, 2)).base.size(), 4u);
}

TEST(ParallelRows, AreFoundWhereConsecutiveAxesAreParallel) {
  EXPECT_EQ(parallel_rows(robots::ur10().chain), (std::vector<int>{1, 2}));
  EXPECT_EQ(parallel_rows(robots::abb_irb120().chain), (std::vector<int>{1}));
  EXPECT_EQ(parallel_rows(robots::puma560().chain), (std::vector<int>{1}));
  EXPECT_EQ(parallel_rows(robots::puma560_modified().chain), (std::vector<int>{2}));
  EXPECT_TRUE(parallel_rows(robots::barrett_wam().chain).empty());
}

}  // namespace
}  // namespace vernier::identifiable_parameters_test
