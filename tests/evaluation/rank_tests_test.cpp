// SPDX-License-Identifier: BSD-3-Clause
// Rank tests against published figures and against all arrangements, counted.

#include "vernier/evaluation/rank_tests.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::rank_tests_test {
namespace {

using vernier_test::complaint;

VectorX of(std::initializer_list<double> values) { return vernier_test::vector(values); }

const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

TEST(Ranks, TiesShareTheirMean) {
  EXPECT_EQ(ranks(of({3, 1, 2})), of({3, 1, 2}));
  EXPECT_EQ(ranks(of({5, 2, 5, 5, -infinity, infinity})), of({4, 2, 4, 4, 1, 6}));
  EXPECT_EQ(ranks(VectorX()).size(), 0);
  EXPECT_EQ(complaint([] { ranks(of({1, nan})); }), "ranks: value 1 is not a number");
}

// The examples of the manuals: R's wilcox.test (Hollander and Wolfe's permeability; ozone in May and August, with
// ties), SciPy's mannwhitneyu.
TEST(RankSum, PublishedFigures) {
  const VectorX term = of({0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46});
  const VectorX early = of({1.15, 0.88, 0.90, 0.74, 1.21});
  const RankTest permeability = rank_sum_test(term, early);
  EXPECT_EQ(permeability.statistic, 35);
  EXPECT_TRUE(permeability.exact);
  EXPECT_NEAR(permeability.p_value / 2, 0.1272, 5e-5);

  const VectorX males = of({19, 22, 16, 29, 24}), females = of({20, 11, 17, 12});
  EXPECT_EQ(rank_sum_test(males, females).statistic, 17);
  EXPECT_NEAR(rank_sum_test(males, females).p_value, 1.0 / 9, 1e-15);
  const RankTest approximate = rank_sum_test(males, females, 0);
  EXPECT_FALSE(approximate.exact);
  EXPECT_NEAR(approximate.p_value, 0.11134688653314041, 1e-14);

  const VectorX may =
      of({41, 36, 12, 18, 28, 23, 19, 8, 7, 16, 11, 14, 18, 14, 34, 6, 30, 11, 1, 11, 4, 32, 23, 45, 115, 37});
  const VectorX august =
      of({39, 9, 16, 78, 35, 66, 122, 89, 110, 44, 28, 65, 22, 59, 23, 31, 44, 21, 9, 45, 168, 73, 76, 118, 84, 85});
  const RankTest ozone = rank_sum_test(may, august);
  EXPECT_FALSE(ozone.exact);
  EXPECT_EQ(ozone.statistic, 127.5);
  EXPECT_NEAR(ozone.p_value, 0.0001208, 5e-8);
}

// R's wilcox.test (Hamilton's depression scale, one-sided p 0.01953); SciPy's wilcoxon (heights of maize).
TEST(SignedRank, PublishedFigures) {
  const VectorX before = of({1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30});
  const VectorX after = of({0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29});
  const RankTest depression = signed_rank_test(before, after);
  EXPECT_EQ(depression.statistic, 40);
  EXPECT_TRUE(depression.exact);
  EXPECT_NEAR(depression.p_value / 2, 0.01953, 5e-6);

  const VectorX maize = of({6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75});
  EXPECT_EQ(signed_rank_test(maize, VectorX::Zero(15)).statistic, 120 - 24);
  EXPECT_EQ(signed_rank_test(maize, VectorX::Zero(15)).p_value, 0.041259765625);
}

// Three ties among five: ranks 1 3 3 3 5, variance 6/12 (6 - 24/20) = 2.4 about 3; without the correction it were 3.
TEST(RankSum, TiesNarrowTheDistribution) {
  const RankTest tied = rank_sum_test(of({1, 2, 2}), of({2, 3}));
  EXPECT_EQ(tied.statistic, 1);
  EXPECT_FALSE(tied.exact);
  EXPECT_NEAR(tied.p_value, std::erfc(1.5 / std::sqrt(2 * 2.4)), 1e-15);
}

// Ranks 2 2 -2 4 of sizes 1 1 1 2: sum 8 about 5, variance 180/24 - 24/48 = 7.
TEST(SignedRank, TiesNarrowTheDistribution) {
  const RankTest tied = signed_rank_test(of({1, 1, -1, 2}), VectorX::Zero(4));
  EXPECT_EQ(tied.statistic, 8);
  EXPECT_FALSE(tied.exact);
  EXPECT_NEAR(tied.p_value, std::erfc(2.5 / std::sqrt(2 * 7.0)), 1e-15);
}

// A pair without a difference is dropped, and then the distribution is the normal one: rank sum 6 of 3 about 3,
// variance 3 x 4 x 7 / 24. So it is where either sample is large.
TEST(RankTests, NormalWhereCountingIsNotMeant) {
  const RankTest dropped = signed_rank_test(of({1, 2, 3, 0}), VectorX::Zero(4));
  EXPECT_EQ(dropped.statistic, 6);
  EXPECT_FALSE(dropped.exact);
  EXPECT_NEAR(dropped.p_value, std::erfc(2.5 / std::sqrt(2 * 3.5)), 1e-15);
  for (const Index many : {49, 50}) {
    const VectorX large = VectorX::LinSpaced(many, 1, 2), one = of({0});
    EXPECT_EQ(rank_sum_test(one, large).exact, many == 49);
    EXPECT_EQ(rank_sum_test(large, one).exact, many == 49);
    EXPECT_EQ(signed_rank_test(large, VectorX::Zero(many)).exact, many == 49);
  }
}

// Ranks 1 and 4 beside 2.5 and 2.5: exactly in the middle, nearer than the correction of a half.
TEST(RankTests, NothingIsLessSignificantThanTheMiddle) {
  const RankTest middle = rank_sum_test(of({1, 3}), of({2, 2}));
  EXPECT_EQ(middle.statistic, 2);
  EXPECT_FALSE(middle.exact);
  EXPECT_EQ(middle.p_value, 1);
}

/// Share of all ways to deal n + m ranks whose U is as far from its mean as the given one, or farther.
double dealt(Index n, Index m, double u) {
  const double mean = static_cast<double>(n * m) / 2;
  long far = 0, all = 0;
  for (unsigned hand = 0; hand < 1u << (n + m); ++hand) {
    if (std::popcount(hand) != n) continue;
    double sum = 0;
    for (Index r = 0; r < n + m; ++r) sum += (hand >> r) & 1u ? static_cast<double>(r + 1) : 0;
    ++all;
    far += std::abs(sum - static_cast<double>(n * (n + 1)) / 2 - mean) >= std::abs(u - mean) ? 1 : 0;
  }
  return static_cast<double>(far) / static_cast<double>(all);
}

TEST(RankSum, AllArrangements) {
  Rng rng(1);
  for (const auto& [n, m] : {std::pair<Index, Index>{1, 1}, {1, 6}, {3, 4}, {5, 2}, {6, 6}, {4, 9}, {9, 4}})
    for (int round = 0; round < 20; ++round) {
      VectorX a(n), b(m);
      for (auto& x : a) x = rng.uniform();
      for (auto& x : b) x = rng.uniform() + 0.1 * round;
      const RankTest test = rank_sum_test(a, b);
      double u = 0;
      for (const double x : a) u += static_cast<double>((b.array() < x).count());
      EXPECT_TRUE(test.exact);
      EXPECT_EQ(test.statistic, u);
      EXPECT_NEAR(test.p_value, dealt(n, m, u), 1e-14) << n << " " << m;
    }
}

TEST(SignedRank, AllSigns) {
  Rng rng(2);
  for (const Index n : {1, 2, 5, 10})
    for (int round = 0; round < 20; ++round) {
      VectorX a(n), b(n);
      for (auto& x : a) x = rng.normal();
      for (auto& x : b) x = rng.normal() + 0.1 * round;
      const RankTest test = signed_rank_test(a, b);
      const double mean = static_cast<double>(n * (n + 1)) / 4;
      long far = 0;
      for (unsigned signs = 0; signs < 1u << n; ++signs) {
        double sum = 0;
        for (Index r = 0; r < n; ++r) sum += (signs >> r) & 1u ? static_cast<double>(r + 1) : 0;
        far += std::abs(sum - mean) >= std::abs(test.statistic - mean) ? 1 : 0;
      }
      EXPECT_NEAR(test.p_value, static_cast<double>(far) / std::pow(2, n), 1e-15);
    }
}

// Swapped samples mirror the statistic and keep p; what is all equal differs in nothing; infinities have their rank.
TEST(RankTests, SymmetryAndEnds) {
  const VectorX a = of({1, 4, 4, 9, infinity}), b = of({4, 2, 7, 8, infinity});
  EXPECT_EQ(rank_sum_test(a, b).statistic + rank_sum_test(b, a).statistic, 25);
  EXPECT_EQ(rank_sum_test(a, b).p_value, rank_sum_test(b, a).p_value);
  EXPECT_EQ(signed_rank_test(a, b).statistic + signed_rank_test(b, a).statistic, 10);
  EXPECT_EQ(signed_rank_test(a, b).p_value, signed_rank_test(b, a).p_value);
  EXPECT_EQ(rank_sum_test(VectorX::Ones(5), VectorX::Ones(4)).p_value, 1);
  EXPECT_EQ(signed_rank_test(a, a).p_value, 1);
  EXPECT_EQ(rank_sum_test(of({1, 2}), of({3, infinity})).p_value, rank_sum_test(of({1, 2}), of({3, 4})).p_value);
  // 49 against 49 apart: 2 of 98 over 49 arrangements, 2.5e28 of them
  const double all = std::exp(std::lgamma(99) - 2 * std::lgamma(50));
  EXPECT_NEAR(rank_sum_test(VectorX::LinSpaced(49, 0, 1), VectorX::LinSpaced(49, 2, 3)).p_value * all, 2, 1e-9);
}

// R: p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm") is 0.03 0.06 0.06 0.02.
TEST(Holm, ByHand) {
  EXPECT_LT(vernier_test::difference(holm(of({0.01, 0.04, 0.03, 0.005})), of({0.03, 0.06, 0.06, 0.02})), 1e-15);
  EXPECT_EQ(holm(of({0.7, 0.9})), of({1, 1}));
  EXPECT_EQ(holm(of({0.2})), of({0.2}));
  EXPECT_EQ(holm(of({1, 0})), of({1, 0}));  // both ends are probabilities
  EXPECT_EQ(holm(VectorX()).size(), 0);
}

TEST(AverageRanks, ByHand) {
  MatrixX values(3, 3);
  values << 0.1, 0.2, 0.3,  //
      5, 5, 9,              //
      2, 3, 1;
  EXPECT_LT(vernier_test::difference(average_ranks(values), of({4.5 / 3, 6.5 / 3, 7.0 / 3})), 1e-15);
  EXPECT_EQ(average_ranks(MatrixX::Constant(1, 1, 7)), of({1}));  // one method over one case
}

TEST(RankTests, Misuse) {
  EXPECT_EQ(complaint([] { rank_sum_test(VectorX(), of({1})); }), "rank_sum_test: samples of 0 and 1 values");
  EXPECT_EQ(complaint([] { rank_sum_test(of({nan}), of({1})); }), "ranks: value 0 is not a number");
  EXPECT_EQ(complaint([] { signed_rank_test(of({1, 2}), of({1})); }), "signed_rank_test: 2 and 1 values are no pairs");
  EXPECT_EQ(complaint([] { signed_rank_test(of({1, nan}), of({1, 2})); }), "ranks: value 0 is not a number");
  EXPECT_EQ(complaint([] { holm(of({0.5, 1.5})); }), "holm: p-value 1.5 must lie in [0, 1]");
  EXPECT_EQ(complaint([] { average_ranks(MatrixX(0, 3)); }), "average_ranks: 0 cases of 3 methods");
}

// Demsar 2006, table 5: q / sqrt(2) at 0.05 and 0.1; his example, 4 methods on 14 data sets, has CD 1.25 (0.05: 2.569).
TEST(CriticalDifference, DemsarsTable) {
  const auto tabled = [](Index methods, double alpha) {
    const auto k = static_cast<double>(methods);
    return critical_difference(methods, 1, alpha) / std::sqrt(k * (k + 1) / 6);
  };
  const double at_5[] = {1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164};
  const double at_10[] = {1.645, 2.052, 2.291, 2.459, 2.589, 2.693, 2.780, 2.855, 2.920};
  for (Index k = 2; k <= 10; ++k) {
    EXPECT_NEAR(tabled(k, 0.05), at_5[k - 2], 1.1e-3) << k;
    EXPECT_NEAR(tabled(k, 0.1), at_10[k - 2], 1.1e-3) << k;
  }
  EXPECT_NEAR(critical_difference(4, 14), 1.25, 5e-3);
  EXPECT_THROW(static_cast<void>(critical_difference(1, 5)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(critical_difference(3, 0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(critical_difference(3, 5, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(critical_difference(3, 5, 0)), std::invalid_argument);
}

// Ten pairs whose squared differences of ranks sum to 194: 1 - 6 * 194 / (10 * 99); z = -0.5273, of which a table of
// the normal distribution has 0.598 beyond.
TEST(RankCorrelation, ByHand) {
  const VectorX a = of({106, 100, 86, 101, 99, 103, 97, 113, 112, 110}), b = of({7, 27, 2, 50, 28, 29, 20, 12, 6, 17});
  const RankCorrelation found = rank_correlation(a, b);
  EXPECT_NEAR(found.rho, -29.0 / 165, 1e-12);
  EXPECT_NEAR(found.p_value, 0.598, 5e-4);
  EXPECT_NEAR(rank_correlation(a, -b).rho, 29.0 / 165, 1e-12);
  EXPECT_NEAR(rank_correlation(a, -b).p_value, found.p_value, 1e-12);
  // ranks 1, 2.5, 2.5, 4 and 2, 1, 3.5, 3.5: deviations -1.5, 0, 0, 1.5 and -0.5, -1.5, 1, 1
  EXPECT_NEAR(rank_correlation(of({1, 2, 2, 4}), of({3, 1, 4, 4})).rho, 2.25 / std::sqrt(4.5 * 4.5), 1e-12);
}

TEST(RankCorrelation, IsNoneOfFewOrEqualValues) {
  for (const RankCorrelation& none :
       {rank_correlation(of({1, 2}), of({3, 4})), rank_correlation(of({1, 2, 3, 4}), of({7, 7, 7, 7}))}) {
    EXPECT_EQ(none.rho, 0);
    EXPECT_EQ(none.p_value, 1);
  }
}

}  // namespace
}  // namespace vernier::rank_tests_test
