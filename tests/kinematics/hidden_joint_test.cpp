// The elimination behind the inverse kinematics of general arms, on loops that are known to close.
#include "vernier/kinematics/detail/hidden_joint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "larger.hpp"
#include "random_chains.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::hidden_joint_test {
namespace {

using detail::AxisLine;

constexpr double pi = std::numbers::pi;

AxisLine random_line(Rng& rng) {
  return {Vector3(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)),
          vernier_test::random_direction(rng)};
}

/// Axes anyhow, the third one along z, and what six turns about them make.
struct KnownLoop {
  detail::ClosedLoop loop;
  std::array<double, 6> q;

  explicit KnownLoop(Rng& rng) {
    loop.closure = Isometry3::Identity();
    for (std::size_t i = 0; i < 6; ++i) {
      loop.axes[i] = i == 2 ? AxisLine{Vector3::Zero(), Vector3(0, 0, 1)} : random_line(rng);
      q[i] = rng.uniform(-pi, pi);
      loop.closure = composed(loop.closure, detail::turn_about(loop.axes[i], q[i]));
    }
  }
};

TEST(HiddenJointWhiteBox, ATurnLeavesItsAxisAloneAndTurnsByTheRightHandRule) {
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const AxisLine axis = random_line(rng);
    const double angle = rng.uniform(-pi, pi);
    const Isometry3 turn = detail::turn_about(axis, angle);
    const Vector3 along = axis.point + rng.uniform(-1, 1) * axis.direction;
    EXPECT_LT((transformed(turn, along) - along).norm(), 1e-15);
    const Vector3 across = axis.direction.cross(vernier_test::random_direction(rng)).normalized();
    const Vector3 turned = std::cos(angle) * across + std::sin(angle) * axis.direction.cross(across);
    EXPECT_LT((transformed(turn, Vector3(along + across)) - along - turned).norm(), 2e-15);
  }
}

TEST(HiddenJointWhiteBox, AnyLineIsTakenToTheZAxis) {
  Rng rng(2);
  for (int trial = 0; trial < 20; ++trial) {
    const AxisLine line = random_line(rng), moved = detail::to_z_axis(line) * line;
    EXPECT_LT((moved.direction - Vector3(0, 0, 1)).norm(), 1e-15);
    EXPECT_LT(moved.point.norm(), 1e-15);
    EXPECT_NEAR(rotation(detail::to_z_axis(line)).determinant(), 1, 1e-15);
  }
}

// The products of (cos 3h, sin 3h, cos h, sin h), h = q4 / 2, and (1, cos q5, sin q5) solve the twelve equations where
// joint 3 has its value, and not elsewhere.
TEST(HiddenJointWhiteBox, JointsThatCloseTheLoopSolveTheEquations) {
  Rng rng(3);
  for (int trial = 0; trial < 20; ++trial) {
    const KnownLoop known(rng);
    const auto pencil = detail::eliminate(known.loop);
    const double h = known.q[3] / 2;
    const double four[] = {std::cos(3 * h), std::sin(3 * h), std::cos(h), std::sin(h)};
    const double five[] = {1, std::cos(known.q[4]), std::sin(known.q[4])};
    const auto residual = [&](double q3) {
      double equations[12][12];
      detail::equations_at(pencil, q3, equations);
      double largest = 0;
      for (int i = 0; i < 12; ++i) {
        double sum = 0;
        for (int c = 0; c < 4; ++c)
          for (int r = 0; r < 3; ++r) sum += equations[3 * c + r][i] * four[c] * five[r];
        largest = vernier_test::larger(largest, std::abs(sum));
      }
      return largest;
    };
    EXPECT_LT(residual(known.q[2]), 1e-13) << trial;
    EXPECT_GT(residual(known.q[2] + 0.1), 1e-3) << trial;
  }
}

// One elimination alone has the value among its own, real but for rounding; complex ones come in pairs.
TEST(HiddenJointWhiteBox, TheValueThatClosesTheLoopIsAmongThoseFound) {
  Rng rng(4);
  for (int trial = 0; trial < 50; ++trial) {
    const KnownLoop known(rng);
    const auto values = detail::hidden_joint_values(detail::eliminate(known.loop));
    ASSERT_EQ(values.count, 16);
    EXPECT_GE(values.condition, 1);
    EXPECT_LT(values.condition, 1e6);
    double nearest = std::numeric_limits<double>::infinity(), sum_of_imaginary = 0;
    for (const auto& angle : values.angles) {
      nearest = std::min(nearest, std::hypot(std::remainder(angle.real() - known.q[2], 2 * pi), angle.imag()));
      sum_of_imaginary += angle.imag();
    }
    EXPECT_LT(nearest, 1e-6) << trial;
    EXPECT_NEAR(sum_of_imaginary, 0, 1e-6) << trial;
  }
}

TEST(HiddenJointWhiteBox, ALoopOfNoNumbersHasNoValues) {
  Rng rng(5);
  KnownLoop known(rng);
  known.loop.axes[1].point.x() = std::numeric_limits<double>::quiet_NaN();
  const auto values = detail::hidden_joint_values(detail::eliminate(known.loop));
  EXPECT_EQ(values.count, 0);
  EXPECT_EQ(values.condition, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace vernier::hidden_joint_test
