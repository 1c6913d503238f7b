// Touches of objects: on their faces, within their extent.

#include "vernier/simulation/touches.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace vernier::touches_test
