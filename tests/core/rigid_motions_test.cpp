// SPDX-License-Identifier: BSD-3-Clause
// Points and parts of poses, by hand.

#include "vernier/core/rigid_motions.hpp"

#include <gtest/gtest.h>

namespace vernier::points_test {
namespace {

TEST(Points, AreRowsAsValues) {
  PointRows points(2, 3);
  points << 1, 2, 3, 5, 6, 15;
  EXPECT_EQ(point(points, 1), Vector3(5, 6, 15));
  EXPECT_EQ(centroid(points), Vector3(3, 4, 9));
  EXPECT_EQ(distances_from(points, Vector3(1, 2, 8)), Eigen::Vector2d(5, 9));
  set_point(points, 0, Vector3(7, 8, 9));
  EXPECT_EQ(point(points, 0), Vector3(7, 8, 9));
  EXPECT_EQ(point(points, 1), Vector3(5, 6, 15));
}

TEST(Points, ConfigurationsAreRowsOfJointValues) {
  JointRows<4> joints(2, 4);
  joints << 1, 2, 3, 4, 5, 6, 7, 8;
  EXPECT_EQ(configuration(joints, 1), JointVector<4>(5, 6, 7, 8));
  set_configuration(joints, 0, JointVector<4>(9, 10, 11, 12));
  EXPECT_EQ(configuration(joints, 0), JointVector<4>(9, 10, 11, 12));
  EXPECT_EQ(configuration(joints, 1), JointVector<4>(5, 6, 7, 8));
  EXPECT_EQ(configuration(JointRows<1>(JointRows<1>::Constant(3, 1, 9)), 2)(0), 9);
}

TEST(Points, PartsOfAPose) {
  Isometry3 pose = Isometry3::Identity();
  pose.translation() = Vector3(1, 2, 3);
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(translation(pose), Vector3(1, 2, 3));
  EXPECT_EQ(rotation(pose), (Matrix3{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}));
}

TEST(Points, RigidMotions) {
  const Matrix3 quarter{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, half{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const Isometry3 first = rigid_motion(quarter, {1, 2, 3}), second = rigid_motion(half, {4, 5, 6});
  EXPECT_EQ(rotation(first), quarter);
  EXPECT_EQ(translation(first), Vector3(1, 2, 3));
  EXPECT_EQ(transformed(first, {7, 8, 9}), Vector3(-7, 9, 12));
  EXPECT_EQ(rotation(composed(first, second)), (Matrix3{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}));
  EXPECT_EQ(translation(composed(first, second)), Vector3(-4, 6, 9));
  EXPECT_EQ(rotation(inverse_of(first)), quarter.transpose());
  EXPECT_EQ(translation(inverse_of(first)), Vector3(-2, 1, -3));
  for (const Isometry3& motion : {rigid_motion(half, {4, 5, 6}), composed(first, second), inverse_of(first)})
    EXPECT_EQ(motion.matrix().row(3), (Eigen::RowVector4d(0, 0, 0, 1)));
}

}  // namespace
}  // namespace vernier::points_test
