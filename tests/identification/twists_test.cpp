// Small motions of poses, against motions themselves.

#include "vernier/identification/detail/twists.hpp"

#include <gtest/gtest.h>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::twists_test {
namespace {

using vernier_test::RealMatrix;

Vector3 random(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

TEST(TwistsWhiteBox, ShiftsAndTurnsAPoseAboutItsPoint) {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const Isometry3 pose = rigid_motion(exp_so3(random(rng)), random(rng));
    const Vector3 shift = random(rng), turn = 0.5 * random(rng).normalized();
    const Vector6 by{shift(0), shift(1), shift(2), turn(0), turn(1), turn(2)};
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
      const Isometry3 about_origin = rigid_motion(turned, origin + s * shift);
      return composed(about_origin, rigid_motion(rotation(pose), translation(pose) - origin));
    };
    RealMatrix twist(6, 1);
    twist.set_block(0, 0, shift);
    twist.set_block(3, 0, turn);
    const RealMatrix expected = RealMatrix(pose_difference(moved(step), moved(-step))) / (2 * step);
    EXPECT_LT((RealMatrix(detail::effect_of_twist(translation(pose) - origin)) * twist - expected).norm(), 1e-8);
  }
}

TEST(TwistsWhiteBox, BothPartsOfColumnsAreTurned) {
  const Matrix3 quarter{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};  // about z
  Rows6 columns{{1, 0}, {0, 2}, {3, 0}, {4, 0}, {0, 5}, {6, 0}};
  detail::turn_columns(quarter, columns);
  EXPECT_EQ(RealMatrix(columns), RealMatrix(6, 2, {0, -2, 1, 0, 3, 0, 0, -5, 4, 0, 6, 0}));
}

}  // namespace
}  // namespace vernier::twists_test
