// Small motions of poses, against motions themselves.

#include "vernier/identification/detail/twists.hpp"

#include <gtest/gtest.h>

#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::twists_test {
namespace {

Vector3 random(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

TEST(TwistsWhiteBox, ShiftsAndTurnsAPoseAboutItsPoint) {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const Isometry3 pose = rigid_motion(exp_so3(random(rng)), random(rng));
    Vector6 by;
    by << random(rng), 0.5 * random(rng).normalized();
    EXPECT_LT((pose_difference(detail::shifted(pose, by), pose) - by).norm(), 1e-14);
  }
}

// A pose that is rigid with a frame, after the frame's twist: central differences.
TEST(TwistsWhiteBox, EffectOfATwistOnAPoseElsewhere) {
  constexpr double step = 1e-5;
  Rng rng(2);
  for (int i = 0; i < 20; ++i) {
    const Vector3 origin = random(rng), shift = random(rng), turn = random(rng);
    const Isometry3 pose = rigid_motion(exp_so3(random(rng)), random(rng));
    const auto moved = [&](double s) {
      const Matrix3 turned = exp_so3(Vector3(s * turn));
      return rigid_motion(turned * pose.linear(), origin + s * shift + turned * (pose.translation() - origin));
    };
    Vector6 twist;
    twist << shift, turn;
    const Vector6 expected = pose_difference(moved(step), moved(-step)) / (2 * step);
    EXPECT_LT((detail::effect_of_twist(pose.translation() - origin) * twist - expected).norm(), 1e-8);
  }
}

TEST(TwistsWhiteBox, BothPartsOfColumnsAreTurned) {
  Matrix3 quarter;  // about z
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Rows6 columns(6, 2);
  columns << 1, 0, 0, 2, 3, 0, 4, 0, 0, 5, 6, 0;
  Rows6 expected(6, 2);
  expected << 0, -2, 1, 0, 3, 0, 0, -5, 4, 0, 6, 0;
  detail::turn_columns(quarter, columns);
  EXPECT_EQ(columns, expected);
}

}  // namespace
}  // namespace vernier::twists_test
