// SPDX-License-Identifier: BSD-3-Clause
// The sign-flip test: all arrangements by hand, draws beside Student's t, and its level.

#include <gtest/gtest.h>

#include <limits>
#include <vernier/core/rng.hpp>
#include <vernier/evaluation/sign_flip_test.hpp>

#include "complaint.hpp"

namespace sign_flip_test_test {
namespace {

using vernier::sign_flip_test;
using vernier::VectorX;

VectorX values(std::initializer_list<double> list) {
  VectorX out(static_cast<vernier::Index>(list.size()));
  std::copy(list.begin(), list.end(), out.begin());
  return out;
}

TEST(SignFlip, CountsArrangementsOfFew) {
  EXPECT_EQ(sign_flip_test(values({1})), 0.5);
  EXPECT_EQ(sign_flip_test(values({1, 2, 3})), 1.0 / 8);
  EXPECT_EQ(sign_flip_test(values({-1, 2, 3})), 2.0 / 8);  // 4 and 6
  EXPECT_EQ(sign_flip_test(values({0, 0})), 1);
  EXPECT_EQ(sign_flip_test(values({0.1, 0.2, -0.3})), 5.0 / 8);  // sums of zero are equal, whatever rounding makes them
}

// Of 24 values that are all positive, no drawn arrangement is as large: 1 / (draws + 1).
TEST(SignFlip, NoSmallerThanItsDraws) { EXPECT_EQ(sign_flip_test(VectorX::Ones(40), 999), 1.0 / 1000); }

// Of 400 sets of noise about zero 5 % have p <= 0.05: 20, give or take three standard deviations.
TEST(SignFlip, HoldsItsLevel) {
  vernier::Rng rng(1);
  int found = 0;
  for (int set = 0; set < 400; ++set) {
    VectorX noise(30);
    for (double& x : noise) x = rng.normal();
    found += sign_flip_test(noise, 999) <= 0.05;
  }
  EXPECT_GE(found, 7);
  EXPECT_LE(found, 33);
}

TEST(SignFlip, RefusesNothingAndNaN) {
  EXPECT_NE(vernier_test::complaint([] { sign_flip_test(VectorX()); }), "");
  EXPECT_NE(vernier_test::complaint([] { sign_flip_test(values({1, std::numeric_limits<double>::quiet_NaN()})); }), "");
}

}  // namespace
}  // namespace sign_flip_test_test
