#include "vernier/evaluation/chi_square.hpp"

#include <gtest/gtest.h>

#include <array>
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

/// Student's quantile at 0.975 of an even number of degrees of freedom, whose distribution is a finite sum (Abramowitz
/// and Stegun 26.7.4).
double student(int v) {
  const auto beyond = [v](double t) {
    const double cosine = v / (v + t * t);  // squared
    double term = 1, sum = 0;
    for (int k = 2; k <= v; k += 2) {
      sum += term;
      term *= cosine * (k - 1) / k;
    }
    return sum * t / std::sqrt(v + t * t) - 0.95;
  };
  double t = 2;
  for (int i = 0; i < 60; ++i) {  // secants
    const double slope = (beyond(t + 1e-4) - beyond(t - 1e-4)) / 2e-4;
    t -= beyond(t) / slope;
  }
  return t;
}

// Of the fourth power of the degrees of freedom nothing is left: what is, times that power, goes to zero with their
// number, by polynomials of its inverse.
TEST(MeanInterval, IsThatOfStudentToTheFourthPower) {
  std::array<double, 4> left{}, inverse{};
  for (std::size_t k = 0; k < 4; ++k) {
    const int v = 16 << k;
    VectorX errors(v + 1);  // mean 0, variance 1
    for (Index i = 0; i <= v; ++i) errors(i) = i == v ? 0 : i % 2 == 0 ? 1 : -1;
    left[k] = (student(v) - MeanInterval::of(errors).upper * std::sqrt(v + 1.0)) * std::pow(v, 4);
    inverse[k] = 1.0 / v;
  }
  EXPECT_GT(left[0], 0.02);
  for (std::size_t order = 1; order < 4; ++order)  // Neville
    for (std::size_t k = 3; k >= order; --k)
      left[k] = (inverse[k - order] * left[k] - inverse[k] * left[k - 1]) / (inverse[k - order] - inverse[k]);
  EXPECT_NEAR(left[3], 0, 6e-6);
}

}  // namespace
}  // namespace vernier::chi_square_test
