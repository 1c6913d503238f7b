// SPDX-License-Identifier: BSD-3-Clause
// The motion of a base over a session, by hand.

#include "vernier/identification/session_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::session_drift_test {
namespace {

using vernier_test::difference;
using vernier_test::RealMatrix;
using vernier_test::vector;

SessionDrift three_knots() {
  SessionDrift out{.begin = 10, .spacing = 5, .centre = {1, 2, 3}};
  out.knots = MatrixX{{1e-3, 3e-3, 0}, {0, 0, 0}, {0, 1e-3, 0}, {0, 0, 0.01}, {0, 0, 0}, {0, 0.02, 0}};
  return out;
}

TEST(SessionDrift, IsLinearBetweenKnotsAndConstantBeyond) {
  const SessionDrift drift = three_knots();
  const RealMatrix knots = drift.knots, first = knots.col(0), second = knots.col(1), last = knots.col(2);
  EXPECT_LT((drift.twist(12.5) - 0.5 * (first + second)).norm(), 1e-18);
  EXPECT_LT((drift.twist(16) - (0.8 * second + 0.2 * last)).norm(), 1e-17);
  EXPECT_EQ(difference(drift.twist(-100), first), 0);
  EXPECT_EQ(difference(drift.twist(10), first), 0);
  EXPECT_EQ(difference(drift.twist(20), last), 0);
  EXPECT_EQ(difference(drift.twist(1e9), last), 0);
}

TEST(SessionDrift, TurnsAboutItsCentre) {
  const SessionDrift drift = three_knots();
  const Isometry3 motion = drift.motion(15);
  EXPECT_LT((transformed(motion, drift.centre) - (drift.centre + Vector3(3e-3, 0, 1e-3))).norm(), 1e-15);
  const Vector3 beside = transformed(motion, Vector3(2, 2, 3));  // one metre along x turns by 20 mrad about z
  EXPECT_LT((beside - (drift.centre + Vector3(3e-3, 0, 1e-3) + Vector3(std::cos(0.02), std::sin(0.02), 0))).norm(),
            1e-15);
  EXPECT_LT((log_so3(rotation(motion)) - Vector3(0, 0, 0.02)).norm(), 1e-15);
}

TEST(SessionDrift, ZerosOfTheJointsStandBelowTheTwist) {
  SessionDrift drift = three_knots();
  EXPECT_EQ(drift.joint_zeros(12.5).size(), 0);  // they rest
  RealMatrix knots(8, 3);
  knots.set_block(0, 0, drift.knots);
  knots.set_block(6, 0, RealMatrix(2, 3, {1e-5, 3e-5, -1e-5, 0, 2e-6, 2e-6}));
  drift.knots = MatrixX(knots);
  EXPECT_LT((drift.joint_zeros(12.5) - vector({2e-5, 1e-6})).norm(), 1e-18);
  EXPECT_LT((drift.joint_zeros(99) - vector({-1e-5, 2e-6})).norm(), 1e-18);
  EXPECT_EQ(difference(drift.twist(12.5), three_knots().twist(12.5)), 0);
}

// 2.5 knots before the session, or after it, of a step with 0.2 mm, 30 urad about z alone and 10 urad of the second
// joint.
TEST(SessionDrift, WalksOnBeyondItsEnds) {
  SessionDrift drift = three_knots();
  const Vector3 point = drift.centre + Vector3(2, 0, 0);  // turning by w about z moves it by 2 m w along y
  const RealMatrix jacobian(6, 2, {0, 0, 0, 0, 0, 0.5, 0, 1, 0, 0, 0, 0});
  const RealMatrix none(6, 6);
  EXPECT_EQ(difference(drift.covariance_beyond(-100, point, jacobian), none), 0);  // nothing is known of its steps
  drift.step_variance = vector({4e-8, 4e-8, 4e-8, 0, 0, 9e-10, 0, 1e-10});
  RealMatrix expected =
      RealMatrix::diagonal(vector({1e-7, 1e-7 + 4 * 2.25e-9, 1e-7 + 0.25 * 2.5e-10, 2.5e-10, 0, 2.25e-9}));
  expected(1, 5) = expected(5, 1) = 2 * 2.25e-9;
  expected(2, 3) = expected(3, 2) = 0.5 * 2.5e-10;
  for (const double time : {10 - 12.5, 20 + 12.5})
    EXPECT_LT((drift.covariance_beyond(time, point, jacobian) - expected).norm(), 1e-21) << time;
  for (const double time : {10.0, 13.0, 20.0})
    EXPECT_EQ(difference(drift.covariance_beyond(time, point, jacobian), none), 0) << time;
}

}  // namespace
}  // namespace vernier::session_drift_test
