// SPDX-License-Identifier: BSD-3-Clause
// The poses of ISO 9283 on the diagonals of a cube, and the largest cube within reach.

#include "vernier/evaluation/iso9283_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "complaint.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rigid_motions.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::iso9283_poses_test {
namespace {

using vernier_test::complaint;
using vernier_test::RealMatrix;

TEST(Iso9283Poses, OnTheDiagonalsOfACube) {
  const Iso9283Cube cube{{0.5, -0.2, 0.7}, 0.6};
  const Matrix3 orientation = exp_so3(Vector3(0, 3, 0.2));
  const double diagonal = 0.6 * std::numbers::sqrt3;
  for (int plane = 1; plane <= 4; ++plane) {
    const auto p = iso9283_poses(cube, orientation, plane);
    EXPECT_EQ(translation(p[0]), cube.centre);
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(RealMatrix(rotation(p[k])), RealMatrix(orientation));
    // 10 % of the diagonal from each corner, so 80 % between opposite ones; the sides of a rectangle 1 to sqrt(2)
    const auto apart = [&](std::size_t i, std::size_t k) { return (translation(p[i]) - translation(p[k])).norm(); };
    EXPECT_NEAR(apart(1, 3), 0.8 * diagonal, 1e-14);
    EXPECT_NEAR(apart(2, 4), 0.8 * diagonal, 1e-14);
    EXPECT_NEAR(apart(1, 2), 0.8 * 0.6, 1e-14);
    EXPECT_NEAR(apart(2, 3), 0.8 * 0.6 * std::numbers::sqrt2, 1e-14);
    EXPECT_GT(p[1](2, 3), 0.7);
    EXPECT_GT(p[2](2, 3), 0.7);
  }
  EXPECT_LT((translation(iso9283_poses(cube)[1]) - (cube.centre + Vector3::Constant(0.24))).norm(), 1e-15);     // at C1
  EXPECT_LT((translation(iso9283_poses(cube)[2]) - (cube.centre + Vector3(-0.24, 0.24, 0.24))).norm(), 1e-15);  // C2
  EXPECT_EQ(complaint([&] { (void)iso9283_poses({{0, 0, 0}, 0}); }), "iso9283_poses: an edge of 0 m, must be positive");
  EXPECT_EQ(complaint([&] { (void)iso9283_poses(cube, orientation, 5); }), "iso9283_poses: plane 5, must be 1 to 4");
  EXPECT_NE(complaint([&] { (void)iso9283_poses(cube, 2 * orientation); }).find("not a rotation"), std::string::npos);
}

TEST(Iso9283Poses, TheLargestCubeWithinReach) {
  // all poses within a ball about the middle of the box: 0.8 x edge x sqrt(3) / 2 = radius
  const Vector3 middle(0.5, 0, 0.5), half(0.4, 0.5, 0.6);
  const auto ball = [&](const Isometry3& pose) { return (translation(pose) - middle).norm() < 0.4; };
  const auto found = largest_iso9283_cube(middle - half, middle + half, ball);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->centre, middle);
  EXPECT_LE(found->edge, 1.0 / std::numbers::sqrt3);
  EXPECT_GT(found->edge, 1.0 / std::numbers::sqrt3 - 0.8 / 50);
  // only in the upper part, which is a place of the search
  const auto above = [&](const Isometry3& pose) { return pose(2, 3) > 0.6; };
  const auto upper = largest_iso9283_cube(middle - half, middle + half, above);
  ASSERT_TRUE(upper);
  for (const Isometry3& pose : iso9283_poses(*upper)) EXPECT_TRUE(above(pose));
  EXPECT_LE(std::abs(upper->centre.z() - middle.z()) + upper->edge / 2, 0.6 + 1e-12);
  EXPECT_GT(upper->edge, 0.5);  // 0.556 fills the box from 0.6 on
  EXPECT_FALSE(largest_iso9283_cube(middle - half, middle + half, [](const Isometry3&) { return false; }));
  EXPECT_NE(complaint([&] { (void)largest_iso9283_cube(middle, middle - half, ball); }).find("must be below"),
            std::string::npos);
  const Vector3 flat(middle.x() + 1, middle.y(), middle.z() + 1);
  EXPECT_NE(complaint([&] { (void)largest_iso9283_cube(middle, flat, ball); }).find("must be below"),
            std::string::npos);
}

// The edges that are tried are fiftieths of the shortest side, from that side itself to one of them.
TEST(Iso9283Poses, EdgesFromTheShortestSideToAFiftieth) {
  const Vector3 lower(1, 2, 3), upper(3, 2.5, 4);
  const auto largest = largest_iso9283_cube(lower, upper, [](const Isometry3&) { return true; });
  ASSERT_TRUE(largest);
  EXPECT_DOUBLE_EQ(largest->edge, 0.5);
  EXPECT_EQ(largest->centre, Vector3(2, 2.25, 3.5));
  // four poses 0.4 x edge x sqrt(3) from the middle
  const auto within = [&](double edge) {
    return largest_iso9283_cube(lower, upper, [&](const Isometry3& pose) {
      return (translation(pose) - Vector3(2, 2.25, 3.5)).norm() <= 0.4 * edge * std::numbers::sqrt3;
    });
  };
  ASSERT_TRUE(within(0.0101));
  EXPECT_DOUBLE_EQ(within(0.0101)->edge, 0.01);
  EXPECT_FALSE(within(0.0099));
}

// Where only the outermost part of the box is within reach, on any side, the cube is at its face.
TEST(Iso9283Poses, TheCubeReachesTheFacesOfTheBox) {
  const Vector3 lower(-1, -1, -1), upper(1, 1, 1);
  for (Index axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto beyond = [&](const Isometry3& pose) { return side * translation(pose)(axis) > 0.6; };
      const auto cube = largest_iso9283_cube(lower, upper, beyond);
      ASSERT_TRUE(cube);
      EXPECT_NEAR(side * cube->centre(axis) + cube->edge / 2, 1, 1e-12) << axis << ' ' << side;
      EXPECT_NEAR(cube->edge, 0.4 / 0.9, 0.04) << axis << ' ' << side;  // nine tenths of it are beyond
    }
}

}  // namespace
}  // namespace vernier::iso9283_poses_test
