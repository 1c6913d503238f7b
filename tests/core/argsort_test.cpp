// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/core/argsort.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace vernier::argsort_test {
namespace {

TEST(Argsort, RisesAndLeavesEqualsInTheirOrder) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  VectorX values(8);
  values << 2, -1, 2, infinity, 0, -infinity, -1, 2;
  EXPECT_EQ(argsort(values), (std::vector<Index>{5, 1, 6, 4, 0, 2, 7, 3}));
  EXPECT_EQ(argsort(VectorX::Constant(40, 0.5)).back(), 39);
  EXPECT_TRUE(argsort(VectorX()).empty());
}

}  // namespace
}  // namespace vernier::argsort_test
