// Points and parts of poses, by hand.

#include "vernier/core/points.hpp"

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

TEST(Points, PartsOfAPose) {
  Isometry3 pose = Isometry3::Identity();
  pose.translation() = Vector3(1, 2, 3);
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(translation(pose), Vector3(1, 2, 3));
  EXPECT_EQ(rotation(pose), (Matrix3{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}));
}

}  // namespace
}  // namespace vernier::points_test
