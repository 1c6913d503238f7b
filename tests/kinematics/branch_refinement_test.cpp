// What counts as a pose.
#include "vernier/kinematics/detail/branch_refinement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "vernier/core/so3.hpp"

namespace vernier::branch_refinement_test {
namespace {

// Rows of unit length at right angles, to 1e-9 in their products.
TEST(IsPoseWhiteBox, ToABillionthAndNotBeyond) {
  for (const double off : {0.8e-9, -0.8e-9, 1.2e-9, -1.2e-9}) {
    const bool expected = std::abs(off) < 1e-9;
    for (int r = 0; r < 3; ++r) {
      Isometry3 longer = Isometry3::Identity();
      longer(r, r) += 0.5 * off;  // the square of the length by `off`
      EXPECT_EQ(detail::is_pose(longer), expected) << r << ' ' << off;
      Isometry3 sheared = Isometry3::Identity();
      sheared(r, (r + 1) % 3) = off;  // the product with the next row
      EXPECT_EQ(detail::is_pose(sheared), expected) << r << ' ' << off;
    }
  }
}

}  // namespace
}  // namespace vernier::branch_refinement_test
