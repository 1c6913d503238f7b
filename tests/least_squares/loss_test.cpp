// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/least_squares/loss.hpp"

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"

namespace vernier::loss_test {
namespace {

TEST(RobustWeight, ByHand) {
  EXPECT_EQ(robust_weight(Loss::squared, 100, 1), 1);
  EXPECT_EQ(robust_weight(Loss::huber, 1.9, 2), 1);
  EXPECT_EQ(robust_weight(Loss::huber, 8, 2), 0.25);
  EXPECT_EQ(robust_weight(Loss::cauchy, 6, 2), 0.1);
  EXPECT_EQ(robust_weight(Loss::cauchy, 2, 2), 0.5);
}

// The median norm of a standard normal number is 0.6745, of a standard normal 3-vector 1.538.
TEST(RobustSigma, ByHand) {
  EXPECT_DOUBLE_EQ(robust_sigma({5, 1, 2}, 1), 2 / 0.6745);
  EXPECT_DOUBLE_EQ(robust_sigma({1, 2, 5e9}, 3), 2 / 1.538);
  EXPECT_DOUBLE_EQ(robust_threshold({1, 2, 5}, 1), 1.345 * 2 / 0.6745);
  EXPECT_DOUBLE_EQ(robust_threshold({1, 2, 5}, 3), 2.8 * 2 / 1.538);
  EXPECT_DOUBLE_EQ(robust_sigma({7, 1, 2, 3}, 1), 3 / 0.6745);  // of an even number the larger of the middle ones
  EXPECT_EQ(robust_sigma({}, 3), 0);
  EXPECT_THROW((void)robust_sigma({1}, 2), std::invalid_argument);
}

// Of normal components, and of such with one vector in ten far off. Medians of 40000: 0.4 % standard error.
TEST(RobustSigma, IsThatOfNormalComponents) {
  Rng rng(1);
  for (const int dimension : {1, 3}) {
    std::vector<double> norms;
    for (int i = 0; i < 40000; ++i) {
      double square = 0;
      for (int k = 0; k < dimension; ++k) square += std::pow(0.3 * rng.normal(), 2);
      norms.push_back(std::sqrt(square));
    }
    EXPECT_NEAR(robust_sigma(norms, dimension), 0.3, 0.02 * 0.3);
    for (std::size_t i = 0; i < norms.size(); i += 10) norms[i] = 1e3;
    EXPECT_NEAR(robust_sigma(norms, dimension), 0.3, 0.2 * 0.3);
  }
}

}  // namespace
}  // namespace vernier::loss_test
