// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/identification/observability.hpp"

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::observability_test {
namespace {

using vernier_test::RealMatrix;
using vernier_test::vector;
using Candidates = std::vector<MatrixX>;

RealMatrix random_matrix(Rng& rng, Index rows, Index cols) {
  RealMatrix out(rows, cols);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = rng.normal();
  return out;
}

RealMatrix random_covariance(Rng& rng, Index n) {
  const RealMatrix root = random_matrix(rng, n, n);
  return root * root.transpose() + 0.1 * RealMatrix::identity(n);
}

/// Covariance once some whitened rows are measured.
RealMatrix with_rows(const RealMatrix& covariance, const RealMatrix& rows) {
  return (covariance.inverse() + rows.transpose() * rows).inverse();
}

TEST(Observability, IndicesByHand) {
  const auto o = Observability::of(vector({4, 2, 1}), 4);
  EXPECT_NEAR(o.o1, 1, 1e-15);  // cube root of 8, over 2
  EXPECT_EQ(o.o2, 0.25);
  EXPECT_EQ(o.o3, 1);
  EXPECT_EQ(o.o4, 0.25);
  EXPECT_NEAR(o.o5, 4.0 / 7, 1e-15);
  EXPECT_NEAR(Observability::of(vector({4, 2, 1}), 16).o1, 0.5, 1e-15);  // the only one that counts poses
}

TEST(Observability, NothingSeenGivesZeros) {
  for (const double least : {0.0, -1e-18}) {
    const auto o = Observability::of(vector({4, 2, least}), 4);
    EXPECT_EQ(o.o1, 0);
    EXPECT_EQ(o.o2, 0);
    EXPECT_EQ(o.o3, 0);
    EXPECT_EQ(o.o4, 0);
    EXPECT_EQ(o.o5, 0);
  }
}

TEST(Observability, MisuseThrows) {
  EXPECT_THROW(Observability::of(VectorX(), 4), std::invalid_argument);
  EXPECT_THROW(Observability::of(vector({4, 2, 1}), 0), std::invalid_argument);
}

TEST(StrongCorrelations, ByHand) {
  // deviations 2, 3, 1; correlations 0.96, -0.99, -0.93
  const RealMatrix covariance(3, 3, {4, 5.76, -1.98, 5.76, 9, -2.79, -1.98, -2.79, 1});
  const auto strong = strong_correlations(covariance);
  ASSERT_EQ(strong.size(), 2u);
  EXPECT_EQ(strong[0].first, 0);
  EXPECT_EQ(strong[0].second, 2);
  EXPECT_NEAR(strong[0].value, -0.99, 1e-15);
  EXPECT_EQ(strong[1].first, 0);
  EXPECT_EQ(strong[1].second, 1);
  EXPECT_NEAR(strong[1].value, 0.96, 1e-15);

  const auto all = strong_correlations(covariance, 0.9);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[2].first, 1);
  EXPECT_EQ(all[2].second, 2);
  EXPECT_NEAR(all[2].value, -0.93, 1e-15);
  EXPECT_TRUE(strong_correlations(covariance, 0.995).empty());
}

TEST(StrongCorrelations, TheLimitCounts) {
  const RealMatrix covariance(2, 2, {1, -0.5, -0.5, 1});
  EXPECT_EQ(strong_correlations(covariance, 0.5).size(), 1u);
  EXPECT_TRUE(strong_correlations(covariance, 0.51).empty());
}

TEST(StrongCorrelations, PassesOverWhatDoesNotVary) {
  const RealMatrix covariance(3, 3, {1, 1, 0, 1, 1, 0, 0, 0, 0});
  const auto strong = strong_correlations(covariance, 0);
  ASSERT_EQ(strong.size(), 1u);
  EXPECT_EQ(strong[0].second, 1);
  EXPECT_TRUE(strong_correlations(MatrixX(0, 0)).empty());
}

TEST(HelpfulPoses, FirstIsTheBestOfAll) {
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const RealMatrix covariance = random_covariance(rng, 7);
    Candidates candidates;
    for (int c = 0; c < 25; ++c) {
      const RealMatrix rows = random_matrix(rng, c % 2 == 0 ? 3 : 6, 7);
      candidates.emplace_back(rows * rng.uniform(0.1, 1));
    }
    const Index unknown = trial % 7;
    Index best = -1;
    double least = covariance(unknown, unknown);
    for (Index c = 0; c < 25; ++c)
      if (const double left = with_rows(covariance, candidates[static_cast<std::size_t>(c)])(unknown, unknown);
          left < least) {
        least = left;
        best = c;
      }
    const auto helpful = helpful_poses(covariance, candidates, unknown, 1);
    ASSERT_EQ(helpful.poses.size(), 1u);
    EXPECT_EQ(helpful.poses[0], best);
    EXPECT_NEAR(helpful.variances[0], least, 1e-11 * covariance(unknown, unknown));
  }
}

TEST(HelpfulPoses, VariancesAreThoseOnceAllBeforeAreMeasured) {
  Rng rng(2);
  RealMatrix covariance = random_covariance(rng, 6);
  Candidates candidates;
  for (int c = 0; c < 12; ++c) candidates.emplace_back(random_matrix(rng, 3, 6));
  const auto helpful = helpful_poses(covariance, candidates, 4, 8);
  ASSERT_EQ(helpful.poses.size(), 8u);
  ASSERT_EQ(helpful.variances.size(), 8u);
  for (std::size_t k = 0; k < 8; ++k) {
    for (const MatrixX& other : candidates)  // each pick is the best one given those before
      EXPECT_LE(helpful.variances[k], with_rows(covariance, other)(4, 4) + 1e-12);
    covariance = with_rows(covariance, candidates[static_cast<std::size_t>(helpful.poses[k])]);
    EXPECT_NEAR(helpful.variances[k], covariance(4, 4), 1e-11);
  }
}

TEST(HelpfulPoses, NamesNoneThatDoNotHelp) {
  const RealMatrix blind(3, 2, {0, 1, 0, 0, 0, 0}), seeing(3, 2, {1, 0, 0, 0, 0, 0});
  const RealMatrix covariance = RealMatrix::identity(2);
  EXPECT_TRUE(helpful_poses(covariance, Candidates{blind, blind}, 0, 3).poses.empty());
  EXPECT_TRUE(helpful_poses(covariance, Candidates{}, 0, 3).poses.empty());
  // a pose may be measured more than once: precision 1, 2, 3, 4
  const auto again = helpful_poses(covariance, Candidates{blind, seeing}, 0, 3);
  EXPECT_EQ(again.poses, (std::vector<Index>{1, 1, 1}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(again.variances[k], 1 / static_cast<double>(k + 2), 1e-15);
}

TEST(HelpfulPoses, MisuseThrows) {
  const RealMatrix covariance = RealMatrix::identity(2);
  EXPECT_THROW(helpful_poses(covariance, Candidates{}, -1, 1), std::invalid_argument);
  EXPECT_THROW(helpful_poses(covariance, Candidates{}, 2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace vernier::observability_test
