// The motion of a base over a session, by hand.

#include "vernier/identification/session_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "vernier/core/so3.hpp"

namespace vernier::session_drift_test {
namespace {

SessionDrift three_knots() {
  SessionDrift out{.begin = 10, .spacing = 5, .centre = {1, 2, 3}};
  out.knots.setZero(6, 3);
  out.knots.col(0) << 1e-3, 0, 0, 0, 0, 0;
  out.knots.col(1) << 3e-3, 0, 1e-3, 0, 0, 0.02;
  out.knots.col(2) << 0, 0, 0, 0.01, 0, 0;
  return out;
}

TEST(SessionDrift, IsLinearBetweenKnotsAndConstantBeyond) {
  const SessionDrift drift = three_knots();
  EXPECT_LT((drift.twist(12.5) - 0.5 * (drift.knots.col(0) + drift.knots.col(1))).norm(), 1e-18);
  EXPECT_LT((drift.twist(16) - (0.8 * drift.knots.col(1) + 0.2 * drift.knots.col(2))).norm(), 1e-17);
  EXPECT_EQ(drift.twist(-100), drift.knots.col(0));
  EXPECT_EQ(drift.twist(10), drift.knots.col(0));
  EXPECT_EQ(drift.twist(20), drift.knots.col(2));
  EXPECT_EQ(drift.twist(1e9), drift.knots.col(2));
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

TEST(SessionDrift, ZerosOfTheJointsStandBelowTheTwist) {
  SessionDrift drift = three_knots();
  EXPECT_EQ(drift.joint_zeros(12.5).size(), 0);  // they rest
  const MatrixX base = drift.knots;
  drift.knots.setZero(8, 3);
  drift.knots.topRows<6>() = base;
  drift.knots.row(6) << 1e-5, 3e-5, -1e-5;
  drift.knots.row(7) << 0, 2e-6, 2e-6;
  EXPECT_LT((drift.joint_zeros(12.5) - Eigen::Vector2d(2e-5, 1e-6)).norm(), 1e-18);
  EXPECT_LT((drift.joint_zeros(99) - Eigen::Vector2d(-1e-5, 2e-6)).norm(), 1e-18);
  EXPECT_EQ(drift.twist(12.5), three_knots().twist(12.5));
}

// 2.5 knots before the session, or after it, of a step with 0.2 mm, 30 urad about z alone and 10 urad of the second
// joint.
TEST(SessionDrift, WalksOnBeyondItsEnds) {
  SessionDrift drift = three_knots();
  const Vector3 point = drift.centre + Vector3(2, 0, 0);  // turning by w about z moves it by 2 m w along y
  MatrixX jacobian = MatrixX::Zero(6, 2);
  jacobian.col(1) << 0, 0, 0.5, 1, 0, 0;
  EXPECT_EQ(drift.covariance_beyond(-100, point, jacobian), Matrix6(Matrix6::Zero()));  // nothing is known of its steps
  drift.step_variance.setZero(8);
  drift.step_variance.head<3>().setConstant(4e-8);
  drift.step_variance(5) = 9e-10;
  drift.step_variance(7) = 1e-10;
  Matrix6 expected = Matrix6::Zero();
  expected.diagonal() << 1e-7, 1e-7 + 4 * 2.25e-9, 1e-7 + 0.25 * 2.5e-10, 2.5e-10, 0, 2.25e-9;
  expected(1, 5) = expected(5, 1) = 2 * 2.25e-9;
  expected(2, 3) = expected(3, 2) = 0.5 * 2.5e-10;
  for (const double time : {10 - 12.5, 20 + 12.5})
    EXPECT_LT((drift.covariance_beyond(time, point, jacobian) - expected).norm(), 1e-21) << time;
  for (const double time : {10.0, 13.0, 20.0})
    EXPECT_EQ(drift.covariance_beyond(time, point, jacobian), Matrix6(Matrix6::Zero())) << time;
}

TEST(SessionDrift, NoneIsNoMotion) {
  const SessionDrift none;
  EXPECT_EQ(none.joint_zeros(3).size(), 0);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.motion(3).matrix(), Isometry3::Identity().matrix());
}

}  // namespace
}  // namespace vernier::session_drift_test
