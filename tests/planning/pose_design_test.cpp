// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/planning/pose_design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::pose_design_test {
namespace {

using vernier_test::RealMatrix;

RealMatrix random_rows(Index rows, Index unknowns, std::uint64_t seed) {
  Rng rng(seed);
  RealMatrix out(rows, unknowns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < unknowns; ++j) out(i, j) = rng.normal() / (1 + 0.2 * static_cast<double>(j));
  return out;
}

RealMatrix information(const RealMatrix& rows, Index block, const std::vector<Index>& chosen,
                       const RealMatrix& measured) {
  RealMatrix out = RealMatrix::identity(rows.cols());
  if (measured.rows() > 0) out += measured.transpose() * measured;
  for (const Index c : chosen) {
    const RealMatrix of_pose = rows.block(c * block, 0, block, rows.cols());
    out += of_pose.transpose() * of_pose;
  }
  return out;
}

struct DesignCase {
  Index block, measured;
  DesignCriterion criterion;

  friend void PrintTo(const DesignCase& one, std::ostream* out) {
    *out << one.block << " values a pose, " << one.measured << " measured, by "
         << (one.criterion == DesignCriterion::information ? "information" : "variance in a region");
  }
};

class PoseDesignUpdates : public testing::TestWithParam<DesignCase> {};

// Every choice is the best by determinants and inverses of whole matrices, and the curves are theirs.
TEST_P(PoseDesignUpdates, EqualDenseRecomputation) {
  const auto [block, of_measured, criterion] = GetParam();
  constexpr Index n = 40, p = 30, count = 15;
  const RealMatrix rows = random_rows(n * block, p, 1), measured = random_rows(of_measured, p, 2),
                   region = random_rows(24, p, 3);
  const PoseDesign design = design_poses(rows, block, {count, criterion, {}}, measured, region);
  ASSERT_EQ(design.chosen.size(), count);
  const double start = information(rows, block, {}, measured).log_determinant();
  const auto mean_variance = [&](const RealMatrix& of) {
    return (region * of.inverse() * region.transpose()).trace() / 8;
  };
  std::vector<Index> chosen;
  for (Index k = 0;; ++k) {
    const RealMatrix now = information(rows, block, chosen, measured);
    EXPECT_NEAR(design.log_det(k), now.log_determinant() - start, 1e-9 * (1 + std::abs(design.log_det(k))));
    EXPECT_NEAR(design.region_variance(k), mean_variance(now), 1e-9 * (1 + mean_variance(now)));
    if (k == count) break;
    Index best = -1;
    double reached = 0;
    for (Index c = 0; c < n; ++c) {
      if (std::find(chosen.begin(), chosen.end(), c) != chosen.end()) continue;
      std::vector<Index> with = chosen;
      with.push_back(c);
      const RealMatrix then = information(rows, block, with, measured);
      const double value = criterion == DesignCriterion::information ? then.log_determinant() : -mean_variance(then);
      if (best < 0 || value > reached) {
        best = c;
        reached = value;
      }
    }
    EXPECT_EQ(design.chosen[static_cast<std::size_t>(k)], best) << "choice " << k;
    chosen.push_back(best);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, PoseDesignUpdates,
                         testing::Values(DesignCase{3, 0, DesignCriterion::information},
                                         DesignCase{6, 0, DesignCriterion::information},
                                         DesignCase{3, 20, DesignCriterion::information},
                                         DesignCase{1, 50, DesignCriterion::information},
                                         DesignCase{3, 0, DesignCriterion::region_variance},
                                         DesignCase{6, 40, DesignCriterion::region_variance}));

TEST(PoseDesign, ReachesNearlyTheBestOfAllChoices) {
  constexpr Index n = 12, count = 5, block = 3, p = 8;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RealMatrix rows = random_rows(n * block, p, seed);
    double best = 0;
    for (unsigned set = 0; set < 1u << n; ++set) {
      std::vector<Index> chosen;
      for (Index c = 0; c < n; ++c)
        if ((set >> c) & 1u) chosen.push_back(c);
      if (chosen.size() == count) best = std::max(best, information(rows, block, chosen, {}).log_determinant());
    }
    const double reached = design_poses(rows, block, {.count = count, .coverage = {}}).log_det(count);
    EXPECT_GE(reached, 0.99 * best) << "seed " << seed;
    EXPECT_LE(reached, best * (1 + 1e-12));
    const double bound = information_bound(rows, block, count);
    EXPECT_GE(bound, best * (1 - 1e-12));
    EXPECT_LE(bound, 1.1 * best);
  }
}

// For one unknown the optimal design has the rows of the largest squares, 9 and 4, and the bound equals it.
TEST(PoseDesign, TheBoundOfOneUnknownIsItsBestChoice) {
  const RealMatrix rows = vernier_test::vector({1, 3, -1, 2});
  EXPECT_NEAR(information_bound(rows, 1, 2, 40), std::log(1 + 9 + 4), 1e-9);
  EXPECT_NEAR(information_bound(rows, 1, 3, 40), std::log(1 + 9 + 4 + 1), 1e-9);
  EXPECT_NEAR(information_bound(rows, 1, 4, 1), std::log(1 + 9 + 4 + 1 + 1), 1e-12);
  EXPECT_NEAR(information_bound(rows.block(1, 0, 1, 1), 1, 1, 1), std::log(1 + 9), 1e-12);
  // with weights of a half each: log 8.5, and the gradient 13 / 8.5 of the best less 7.5 / 8.5 of the weights
  EXPECT_NEAR(information_bound(rows, 1, 2, 1), std::log(8.5) + 5.5 / 8.5, 1e-12);
}

// Two unknowns and weights of a fifth each: log det of ((10.4, -4.8), (-4.8, 7.4)), and the gradients, the fifth of
// which is largest. The next iteration gives a larger bound, a later one a smaller.
TEST(PoseDesign, TheBoundIsTheSmallestOfAllIterations) {
  const RealMatrix rows(5, 2, {3, -4, 3, 0, -3, 4, 2, 0, 4, 0});
  const double determinant = 10.4 * 7.4 - 4.8 * 4.8, first = 7.4 * 9 - 2 * 4.8 * 12 + 10.4 * 16;
  const double sum = 2 * first + 7.4 * (9 + 4 + 16);
  const double by_hand = std::log(determinant) + (7.4 * 16 - 0.2 * sum) / determinant;
  EXPECT_NEAR(information_bound(rows, 1, 1, 1), by_hand, 1e-12);
  EXPECT_NEAR(information_bound(rows, 1, 1, 2), by_hand, 1e-12);
  EXPECT_NEAR(information_bound(rows, 1, 1, 4), by_hand, 1e-12);
  EXPECT_LT(information_bound(rows, 1, 1, 5), by_hand - 0.01);
}

// One unknown: each measurement adds its square to a precision that begins with 1, and with what was measured.
TEST(PoseDesign, OfOneUnknownByHand) {
  const RealMatrix rows = vernier_test::vector({0.1, 2, 0.01, 1}), measured = vernier_test::vector({3}),
                   region = vernier_test::vector({1, 2, 3});
  for (const bool before : {false, true}) {
    const PoseDesign design =
        design_poses(rows, 1, {.count = 4, .coverage = {}}, before ? MatrixX(measured) : MatrixX(), region);
    EXPECT_EQ(design.chosen, (std::vector<Index>{1, 3, 0, 2}));
    const double start = before ? 10 : 1;
    double precision = start;
    for (const Index k : {0, 1, 2, 3, 4}) {
      if (k > 0) precision += std::pow(rows(design.chosen[static_cast<std::size_t>(k - 1)]), 2);
      EXPECT_NEAR(design.log_det(k), std::log(precision / start), 1e-13) << k;
      EXPECT_NEAR(design.region_variance(k), (1 + 4 + 9) / precision, 1e-12) << k;  // of a point, of three rows
    }
  }
}

TEST(PoseDesign, OfEqualCandidatesTakesTheFirst) {
  const RealMatrix one = random_rows(3, 6, 5);
  RealMatrix rows(30, 6);
  for (Index c = 0; c < 10; ++c) rows.set_block(3 * c, 0, one);
  EXPECT_EQ(design_poses(rows, 3, {.count = 4, .coverage = {}}).chosen, (std::vector<Index>{0, 1, 2, 3}));
}

// A bin that lacks several measurements counts once, and each chosen row reduces what it lacks by one.
TEST(PoseDesign, BinsThatLackSeveralCountOnceEach) {
  const RealMatrix equal = vernier_test::vector({1, 1, 1});
  const Eigen::MatrixXi two_each{{2, 3}, {0, 1}, {3, 3}};
  const PoseDesign several =
      design_poses(equal, 1, {.count = 2, .coverage = {two_each, Eigen::VectorXi{{1, 1, 5, 0}}}});
  EXPECT_EQ(several.chosen, (std::vector<Index>{1, 0}));  // two bins before one
  EXPECT_EQ(std::vector<int>(several.missing.begin(), several.missing.end()), (std::vector<int>{0, 0, 4, 0}));

  const RealMatrix rows = vernier_test::vector({5, 0.1, 0.2, 0.3});
  const Eigen::MatrixXi one_each{{1}, {0}, {0}, {0}};
  const PoseDesign twice = design_poses(rows, 1, {.count = 4, .coverage = {one_each, Eigen::VectorXi{{2, 0}}}});
  EXPECT_EQ(twice.chosen, (std::vector<Index>{3, 2, 0, 1}));  // two for the bin, then by what they say
}

// The region's x is predicted from x + y, and by y alone only when that is known: y gains nothing at first, but as
// soon as x + y was measured it gains more than a bad measurement of x, which gained more before.
TEST(PoseDesign, WhatHelpsARegionMayGrowByAChoice) {
  const RealMatrix rows(3, 2, {0, 10, 0.3, 0, 10, 10}), region(3, 2, {1, 0, 0, 0, 0, 0});
  const PoseDesign design = design_poses(rows, 1, {3, DesignCriterion::region_variance, {}}, MatrixX(), region);
  EXPECT_EQ(design.chosen, (std::vector<Index>{2, 0, 1}));
  // the covariance after x + y is I - 100/201 of ones; y then explains 4.975^2 / 51.25 of the variance of x
  const double ratio = 100.0 / 201, left = 1 - ratio - 100 * ratio * ratio / (1 + 100 * (1 - ratio));
  EXPECT_NEAR(design.region_variance(1), 1 - ratio, 1e-12);
  EXPECT_NEAR(design.region_variance(2), left, 1e-12);
  EXPECT_NEAR(design.region_variance(3), 1 / (1 / left + 0.09), 1e-12);
}

TEST(PoseDesign, OfNoChoices) {
  const RealMatrix rows = random_rows(12, 4, 1), region = random_rows(6, 4, 2);
  const PoseDesign none = design_poses(rows, 3, {}, MatrixX(), region);
  EXPECT_TRUE(none.chosen.empty());
  ASSERT_EQ(none.log_det.size(), 1);
  EXPECT_EQ(none.log_det(0), 0);
  ASSERT_EQ(none.region_variance.size(), 1);
  EXPECT_NEAR(none.region_variance(0), (region * region.transpose()).trace() / 2, 1e-12);
  EXPECT_EQ(information_bound(rows, 3, 0), 0);
  EXPECT_EQ(information_bound(MatrixX(0, 4), 3, 0), 0);
}

TEST(PoseDesign, RefusesWhatIsNotFinite) {
  const RealMatrix good = random_rows(12, 4, 1);
  for (const int bad : {0, 1, 2}) {
    std::array<RealMatrix, 3> parts{good, random_rows(3, 4, 2), random_rows(3, 4, 3)};
    parts[static_cast<std::size_t>(bad)](2, 1) = std::nan("");
    EXPECT_EQ(vernier_test::complaint(
                  [&] { (void)design_poses(parts[0], 3, {.count = 1, .coverage = {}}, parts[1], parts[2]); }),
              "design_poses: a row is not finite")
        << bad;
  }
}

TEST(PoseDesign, RefusesWhatDoesNotMatch) {
  using vernier_test::complaint;
  const RealMatrix rows = random_rows(12, 4, 1);
  const auto design = [&](Index block, Index count, const MatrixX& measured = {}, const MatrixX& region = {},
                          DesignCriterion criterion = DesignCriterion::information) {
    return complaint([&] { (void)design_poses(rows, block, {count, criterion, {}}, measured, region); });
  };
  EXPECT_EQ(design(3, 2), "");
  EXPECT_EQ(design(5, 2), "design_poses: 12 rows are no multiple of 5");
  EXPECT_EQ(design(3, 5), "design_poses: 5 of 4 candidates");
  EXPECT_EQ(design(3, 1, random_rows(3, 5, 1)), "design_poses: measured rows of 5 unknowns, candidates of 4");
  EXPECT_EQ(design(3, 1, {}, random_rows(3, 5, 1)), "design_poses: a region of 5 unknowns, candidates of 4");
  EXPECT_EQ(design(3, 1, {}, random_rows(4, 4, 1)), "design_poses: 4 rows of the region are no multiple of 3");
  EXPECT_EQ(design(2, 1, {}, random_rows(4, 4, 1)), "design_poses: 4 rows of the region are no multiple of 3");
  EXPECT_EQ(design(0, 1), "design_poses: 0 rows a candidate, must be 1 to 6");
  EXPECT_EQ(design(12, 1), "design_poses: 12 rows a candidate, must be 1 to 6");
  EXPECT_EQ(complaint([] { (void)design_poses(random_rows(14, 4, 1), 7, {.count = 1, .coverage = {}}); }),
            "design_poses: 7 rows a candidate, must be 1 to 6");
  EXPECT_EQ(design(3, -1), "design_poses: -1 of 4 candidates");
  const auto in_bins = [&](const Eigen::MatrixXi& bins) {
    const PoseDesignOptions options{.count = 1, .coverage = {bins, Eigen::VectorXi{{1, 1}}}};
    return complaint([&] { (void)design_poses(rows, 3, options); });
  };
  EXPECT_EQ(in_bins(Eigen::MatrixXi{{0}, {1}, {1}, {0}}), "");
  EXPECT_EQ(in_bins(Eigen::MatrixXi{{0}, {1}, {2}, {0}}), "design_poses: a bin is not in 0 .. 1");
  EXPECT_EQ(in_bins(Eigen::MatrixXi{{0}, {-1}, {1}, {0}}), "design_poses: a bin is not in 0 .. 1");
  EXPECT_EQ(in_bins(Eigen::MatrixXi{{0}, {1}, {1}}), "design_poses: bins of 3 candidates, expected 4");
  EXPECT_EQ(complaint([&] { (void)information_bound(rows, 5, 1); }), "information_bound: 12 rows are no multiple of 5");
  EXPECT_EQ(complaint([&] { (void)information_bound(rows, 3, 1, 0); }),
            "information_bound: 0 iterations, must be at least 1");
  EXPECT_EQ(design(3, 1, {}, {}, DesignCriterion::region_variance),
            "design_poses: no region whose variance could be reduced");
  EXPECT_NE(design(3, 1, MatrixX::Constant(3, 4, std::nan(""))), "");
  EXPECT_EQ(complaint([&] { (void)information_bound(rows, 3, 9); }), "information_bound: 9 of 4 candidates");
}

}  // namespace
}  // namespace vernier::pose_design_test
