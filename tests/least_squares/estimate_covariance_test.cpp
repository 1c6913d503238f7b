// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/least_squares/estimate_covariance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::estimate_covariance_test {
namespace {

using vernier_test::RealMatrix;
using vernier_test::vector;

RealMatrix random_matrix(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  RealMatrix out(rows, columns);
  for (Index j = 0; j < columns; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = rng.normal();
  return out;
}

// J = diag(1, 2), rows of variances 4 and 9, a prior of weight 3 and variance 5 on the first unknown:
// A = diag(4, 4), A^-1 diag(1 * 4 + 9 * 5, 4 * 9) A^-1 = diag(49 / 16, 36 / 16).
TEST(EstimateCovariance, ByHandWithAPrior) {
  const EstimateCovariance c(RealMatrix(2, 2, {1, 0, 0, 2}), vector({4, 9}), vector({3, 0}), vector({5, 100}));
  EXPECT_LT((c.inverse - RealMatrix::identity(2) / 4).norm(), 1e-15);
  EXPECT_LT((c.covariance - RealMatrix(2, 2, {49.0 / 16, 0, 0, 36.0 / 16})).norm(), 1e-14);
  EXPECT_EQ(c.rank, 2);
  EXPECT_NEAR(c.condition, 2, 1e-14);  // of the rows alone
  EXPECT_LT((c.singular_values - vector({2, 1})).norm(), 1e-14);
}

TEST(EstimateCovariance, EqualsTheSandwichOfDenseMatrices) {
  const RealMatrix j = random_matrix(12, 4, 5);  // few rows
  const RealMatrix root = random_matrix(12, 1, 6), rows = root.times(root), prior = vector({0.5, 0, 20, 0}),
                   variance = vector({4, 7, 0.1, 9});
  const RealMatrix a = (j.transpose() * j + RealMatrix::diagonal(prior)).inverse();
  const RealMatrix middle =
      j.transpose() * RealMatrix::diagonal(rows) * j + RealMatrix::diagonal(prior.times(variance).times(prior));
  const EstimateCovariance c(j, rows, prior, variance);
  EXPECT_LT((c.inverse - a).norm(), 1e-12 * a.norm());
  EXPECT_LT((c.covariance - a * middle * a).norm(), 1e-12 * (a * middle * a).norm());
}

TEST(EstimateCovariance, SaysWhenTheRankIsDeficient) {
  RealMatrix j = random_matrix(40, 3, 4);
  j.set_block(0, 2, j.col(0) + j.col(1));
  const EstimateCovariance p(j, VectorX::Ones(40), VectorX::Zero(3), VectorX::Zero(3));
  EXPECT_EQ(p.rank, 2);
  EXPECT_TRUE(std::isinf(p.condition));
  EXPECT_EQ(p.covariance.size(), 0);
  EXPECT_EQ(EstimateCovariance(j, VectorX::Ones(40), VectorX::Ones(3), VectorX::Ones(3)).covariance.rows(), 3);
}

// Columns count as dependent where a singular value is below 1e-12 of the largest, whatever their unit.
TEST(EstimateCovariance, RankDoesNotDependOnTheUnit) {
  const RealMatrix zeros(2, 1), ones = vector({1, 1});
  for (const double unit : {1e-14, 1.0, 1e14}) {
    const EstimateCovariance full(RealMatrix::diagonal(vector({unit, 1e-10 * unit})), ones, zeros, zeros);
    EXPECT_EQ(full.rank, 2);
    EXPECT_NEAR(full.condition, 1e10, 1);
    ASSERT_EQ(full.covariance.rows(), 2);
    EXPECT_NEAR(full.covariance(1, 1) * unit * unit, 1e20, 1e8);
    const EstimateCovariance deficient(RealMatrix::diagonal(vector({unit, 1e-13 * unit})), ones, zeros, zeros);
    EXPECT_EQ(deficient.rank, 1);
    EXPECT_TRUE(std::isinf(deficient.condition));
    EXPECT_EQ(deficient.covariance.size(), 0);
  }
}

// Where a prior has no weight its variance may be unknown; a problem without unknowns is well conditioned.
TEST(EstimateCovariance, WhatIsNotThereDoesNotMatter) {
  const EstimateCovariance c(RealMatrix::identity(2), vector({4, 9}), vector({0, 1}), vector({std::nan(""), 3}));
  EXPECT_LT((c.covariance - RealMatrix::diagonal(vector({4, 3}))).norm(), 1e-14);  // (9 + 3) / 4
  const EstimateCovariance none(RealMatrix(3, 0), vector({1, 1, 1}), RealMatrix(0, 1), RealMatrix(0, 1));
  EXPECT_EQ(none.rank, 0);
  EXPECT_EQ(none.condition, 1);
}

}  // namespace
}  // namespace vernier::estimate_covariance_test
