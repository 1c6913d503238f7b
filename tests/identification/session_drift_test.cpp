// The motion of a base over a session, by hand.

#include "vernier/identification/session_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "vernier/core/so3.hpp"

namespace vernier::session_drift_test {
namespace {

SessionDrift three_knots() {
  SessionDrift out{.begin = 10, .spacing = 5, .centre = {1, 2, 3}};
  out.twists.setZero(6, 3);
  out.twists.col(0) << 1e-3, 0, 0, 0, 0, 0;
  out.twists.col(1) << 3e-3, 0, 1e-3, 0, 0, 0.02;
  out.twists.col(2) << 0, 0, 0, 0.01, 0, 0;
  return out;
}

TEST(SessionDrift, IsLinearBetweenKnotsAndConstantBeyond) {
  const SessionDrift drift = three_knots();
  EXPECT_LT((drift.twist(12.5) - 0.5 * (drift.twists.col(0) + drift.twists.col(1))).norm(), 1e-18);
  EXPECT_LT((drift.twist(16) - (0.8 * drift.twists.col(1) + 0.2 * drift.twists.col(2))).norm(), 1e-17);
  EXPECT_EQ(drift.twist(-100), drift.twists.col(0));
  EXPECT_EQ(drift.twist(10), drift.twists.col(0));
  EXPECT_EQ(drift.twist(20), drift.twists.col(2));
  EXPECT_EQ(drift.twist(1e9), drift.twists.col(2));
}

TEST(SessionDrift, TurnsAboutItsCentre) {
  const SessionDrift drift = three_knots();
  const Isometry3 motion = drift.motion(15);
  EXPECT_LT((motion * drift.centre - (drift.centre + Vector3(3e-3, 0, 1e-3))).norm(), 1e-15);
  const Vector3 beside = motion * Vector3(2, 2, 3);  // one metre along x turns by 20 mrad about z
  EXPECT_LT((beside - (drift.centre + Vector3(3e-3, 0, 1e-3) + Vector3(std::cos(0.02), std::sin(0.02), 0))).norm(),
            1e-15);
  EXPECT_LT((log_so3(motion.linear()) - Vector3(0, 0, 0.02)).norm(), 1e-15);
}

TEST(SessionDrift, NoneIsNoMotion) {
  const SessionDrift none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.motion(3).matrix(), Isometry3::Identity().matrix());
}

}  // namespace
}  // namespace vernier::session_drift_test
