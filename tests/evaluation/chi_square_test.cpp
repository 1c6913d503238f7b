// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/evaluation/chi_square.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/evaluation/mean_interval.hpp"

namespace vernier::chi_square_test {
namespace {

using vernier_test::complaint;

// One degree of freedom is a squared normal value, two an exponential, and any even number a finite sum.
TEST(ChiSquare, EqualsClosedForms) {
  for (const double x : {1e-8, 0.01, 0.5, 1.0, 2.9, 3.1, 7.8147, 30.0, 120.0, 700.0}) {
    EXPECT_NEAR(chi_square_tail(x, 1), std::erfc(std::sqrt(x / 2)), 1e-12 * chi_square_tail(x, 1) + 1e-15) << x;
    EXPECT_NEAR(chi_square_tail(x, 2), std::exp(-x / 2), 1e-11 * std::exp(-x / 2) + 1e-15) << x;
    for (const int half : {3, 20, 150}) {
      double term = 1, sum = 0;
      for (int k = 0; k < half; ++k) {
        sum += term;
        term *= x / 2 / (k + 1);
      }
      const double expected = sum * std::exp(-x / 2);
      EXPECT_NEAR(chi_square_tail(x, 2 * half), expected, 1e-10 * expected + 1e-13) << x << ' ' << half;
    }
  }
  EXPECT_NEAR(chi_square_tail(7.814727903251179, 3), 0.05, 1e-12);
  EXPECT_EQ(chi_square_tail(0, 3), 1);
  EXPECT_EQ(chi_square_tail(std::numeric_limits<double>::infinity(), 3), 0);
  EXPECT_NE(complaint([] { (void)chi_square_tail(1, 0); }).find("0 degrees of freedom"), std::string::npos);
  EXPECT_NE(complaint([] { (void)chi_square_tail(-1, 2); }).find("-1 must not be negative"), std::string::npos);
}

// Quantiles of Student's t from tables. The expansion ends with the fourth power of the degrees of freedom: what is
// left is of the fifth, 0.8 of it.
TEST(MeanInterval, IsThatOfStudent) {
  for (const auto& [n, t] : {std::pair<Index, double>{5, 2.776445105},
                             {6, 2.570581836},
                             {10, 2.262157163},
                             {31, 2.042272456},
                             {1001, 1.962339081}}) {
    const double fifth = std::pow(static_cast<double>(n - 1), -5);
    Rng rng(static_cast<std::uint64_t>(n));
    VectorX errors(n);
    for (double& e : errors) e = 10 + rng.normal();
    const double sd = std::sqrt((errors.array() - errors.mean()).square().sum() / static_cast<double>(n - 1));
    const MeanInterval interval = MeanInterval::of(errors);
    EXPECT_NEAR((interval.upper - interval.mean) / (sd / std::sqrt(static_cast<double>(n))), t - 0.8 * fifth,
                0.1 * fifth + 2e-9)
        << n;
    EXPECT_NEAR(interval.upper - interval.mean, interval.mean - interval.lower, 1e-12) << n;
  }
  for (const Index few : {1, 4}) {  // errors without an interval but that they are not negative
    const MeanInterval interval = MeanInterval::of(VectorX::Constant(few, 0.25));
    EXPECT_EQ(interval.mean, 0.25);
    EXPECT_EQ(interval.lower, 0);
    EXPECT_TRUE(std::isinf(interval.upper));
  }
  EXPECT_EQ(MeanInterval::of(VectorX::Unit(9, 2)).lower, 0);
  EXPECT_NE(complaint([] { (void)MeanInterval::of(VectorX()); }).find("no errors"), std::string::npos);
}

// Readings of one pose are one piece of evidence: the interval is that of the means of poses.
TEST(MeanInterval, OfGroupsIsThatOfTheirMeans) {
  const VectorX means = (VectorX(6) << 1, 2, 4, 3, 6, 2).finished();
  VectorX errors(12);
  std::vector<Index> groups;
  for (Index i = 0; i < 12; ++i) {
    errors(i) = means(i % 6) + (i < 6 ? -0.5 : 0.5);
    groups.push_back(i % 6);
  }
  const MeanInterval grouped = MeanInterval::of(errors, groups), expected = MeanInterval::of(means);
  EXPECT_NEAR(grouped.mean, expected.mean, 1e-14);
  EXPECT_NEAR(grouped.upper, expected.upper, 1e-14);
  EXPECT_GT(grouped.upper - grouped.mean, MeanInterval::of(errors).upper - grouped.mean);
  EXPECT_EQ(MeanInterval::of(errors, {}).upper, MeanInterval::of(errors).upper);
  groups.pop_back();
  EXPECT_NE(complaint([&] { (void)MeanInterval::of(errors, groups); }).find("11 groups for 12 errors"),
            std::string::npos);
}

}  // namespace
}  // namespace vernier::chi_square_test
