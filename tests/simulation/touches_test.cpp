// SPDX-License-Identifier: BSD-3-Clause
// Touches of objects: on their faces, within their extent.

#include "vernier/simulation/touches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/kinematics/robots.hpp"

namespace vernier::touches_test {
namespace {

TEST(Touch, FacesAreTouchedWithinTheirExtent) {
  const DhChain<6> arm = robots::abb_irb120().chain;
  const Vector3 normal = Vector3(0.3, -0.2, 0.9).normalized();
  const VirtualObject plate{ContactKind::plane, Vector3(0.4, 0.1, 0.3), normal, 0.05};
  VectorX faces = VectorX::Zero(60);
  for (Index i = 0; i < 60; i += 2) faces(i) = 0.02;
  const Contact contact = touch(arm, plate, "plate", faces, abb_irb120_operating_region().limits, 0, 1);
  ASSERT_EQ(contact.size(), 60);
  const PointRows points = arm.positions(JointRows<6>(contact.joints()));
  double farthest = 0;
  for (Index i = 0; i < 60; ++i) {
    const Vector3 from = point(points, i) - plate.point, height = normal.dot(from) * normal;
    EXPECT_NEAR(normal.dot(from), faces(i), 1e-9) << i;
    farthest = std::max(farthest, (from - height).norm());
  }
  EXPECT_LE(farthest, 0.05);
  EXPECT_GT(farthest, 0.045);
}

TEST(Touch, BallsAreTouchedAtTheirRadiusAndSocketsWhereTheyAre) {
  const DhChain<6> arm = robots::abb_irb120().chain;
  const auto limits = abb_irb120_operating_region().limits;
  const Vector3 centre(0.4, 0.1, 0.3), direction = Vector3(1, 2, -2) / 3;
  VectorX known = VectorX::Constant(20, 0.03);
  for (Index i = 0; i < 20; i += 2) known(i) = 0.05;
  for (const ContactKind kind : {ContactKind::ball, ContactKind::socket}) {
    const Contact contact = touch(arm, {kind, centre, direction, 0}, "object", known, limits, 0, 2);
    const PointRows points = arm.positions(JointRows<6>(contact.joints()));
    for (Index i = 0; i < 20; ++i) {
      const Vector3 from = point(points, i) - centre, bar = known(i) * direction;
      if (kind == ContactKind::ball) {
        EXPECT_NEAR(from.norm(), known(i), 1e-9);
      } else {
        EXPECT_LT((from - bar).norm(), 1e-9);
      }
    }
  }
}

// Noise lies between the tool point and what is touched: across a plane, one of its components is left. Five deviations
// of the estimate.
TEST(Touch, ScattersAsItsSensorDoes) {
  const DhChain<6> arm = robots::abb_irb120().chain;
  const Vector3 normal(0.6, 0, 0.8), centre(0.4, 0.1, 0.3);
  const auto limits = abb_irb120_operating_region().limits;
  const Index n = 500;
  const double sigma = 0.1e-3;
  const auto heights = [&](std::uint64_t seed) {
    const Contact contact =
        touch(arm, {ContactKind::plane, centre, normal, 0.1}, "plate", VectorX::Zero(n), limits, sigma, seed);
    const PointRows points = arm.positions(JointRows<6>(contact.joints()));
    vernier_test::RealMatrix out(n, 1);
    for (Index i = 0; i < n; ++i) {
      out(i) = normal.dot(point(points, i) - centre) / sigma;
      EXPECT_TRUE(limits.contains(configuration(JointRows<6>(contact.joints()), i)));
    }
    return out;
  };
  const auto height = heights(3);
  EXPECT_NEAR(height.mean(), 0, 5 / std::sqrt(500.0));
  EXPECT_NEAR(height.squared_norm() / 500, 1, 5 * std::sqrt(2 / 500.0));
  EXPECT_EQ(height, heights(3));
  EXPECT_NE(height(0), heights(4)(0));
}

TEST(Touch, WhatIsOutOfReachIsSaid) {
  const DhChain<6> arm = robots::abb_irb120().chain;
  EXPECT_EQ(vernier_test::complaint([&] {
              (void)touch(arm, {ContactKind::socket, Vector3(2, 0, 0)}, "far socket", VectorX::Zero(1),
                          robots::abb_irb120().limits, 0, 1);
            }),
            "touch: the arm hardly reaches far socket");
}

}  // namespace
}  // namespace vernier::touches_test
