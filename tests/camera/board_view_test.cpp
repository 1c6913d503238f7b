// SPDX-License-Identifier: BSD-3-Clause
// When a board is well seen, and which places of it show most of an arm's joints.

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "projection.hpp"
#include "vernier/camera/board_view.hpp"
#include "vernier/core/so3.hpp"

namespace vernier::board_view_test {
namespace {

const BoardView view{.camera = vernier_test::machine_camera(),
                     .board = {.rows = 7, .columns = 9, .square = 0.03},
                     .nearest = 0.3,
                     .farthest = 0.8,
                     .largest_tilt = 0.7};

/// A board before the camera, turned about its middle.
Isometry3 before_camera(double distance, const Vector3& turn, double aside = 0) {
  const Matrix3 rotated = exp_so3(turn);
  return rigid_motion(rotated, Vector3(Vector3(aside, 0, distance) - rotated * view.board.middle()));
}

TEST(BoardView, SeesFromThePrintedSideWithinDistanceAndTilt) {
  const Vector3 none = Vector3::Zero();
  EXPECT_TRUE(view.sees(before_camera(0.5, none)));
  EXPECT_TRUE(view.sees(view.frontal()));
  EXPECT_FALSE(view.sees(before_camera(0.29, none)));
  EXPECT_FALSE(view.sees(before_camera(0.81, none)));
  EXPECT_TRUE(view.sees(before_camera(0.5, Vector3(0.69, 0, 0))));
  EXPECT_FALSE(view.sees(before_camera(0.5, Vector3(0.71, 0, 0))));
  EXPECT_FALSE(view.sees(before_camera(0.5, Vector3(3.1, 0, 0))));  // from behind
  EXPECT_FALSE(view.sees(before_camera(0.5, none, 0.25)));          // over the edge of the image
  EXPECT_FALSE(view.sees(before_camera(-0.5, none)));
}

// An arm of one joint that turns about z with a camera that looks outwards: a place shows the angles around it, and the
// second place is where the first one is not seen.
TEST(BoardView, PlacesShowDifferentPartsOfTheRange) {
  std::vector<Isometry3> flanges;
  MatrixX joints(360, 1);
  for (Index i = 0; i < 360; ++i) {
    joints(i, 0) = (static_cast<double>(i) - 180) * 3.14159265358979 / 180;
    flanges.push_back(rigid_motion(exp_so3(Vector3(0, 0, joints(i, 0))), Vector3::Zero()));
  }
  const Isometry3 outwards = rigid_motion(exp_so3(Vector3(0, 1.5707963267948966, 0)), Vector3(0.1, 0, 0));
  for (const bool on_flange : {true, false}) {
    const Isometry3 carried =
        on_flange ? outwards
                  : composed(outwards, rigid_motion(exp_so3(Vector3(3.14159265358979, 0, 0)), Vector3::Zero()));
    const BoardPlaces found =
        propose_places(view, on_flange, carried, flanges, joints, 2, std::numeric_limits<double>::quiet_NaN());
    ASSERT_EQ(found.in_base.size(), 2u);
    std::vector<int> seen(2, 0);
    for (std::size_t i = 0; i < flanges.size(); ++i) {
      if (found.place[i] < 0) continue;
      ++seen[static_cast<std::size_t>(found.place[i])];
      const Isometry3 end = composed(flanges[i], carried),
                      place = found.in_base[static_cast<std::size_t>(found.place[i])];
      EXPECT_TRUE(view.sees(on_flange ? composed(inverse_of(end), place) : composed(inverse_of(place), end)));
    }
    EXPECT_GT(seen[0], 10);
    EXPECT_GT(seen[1], 10);
  }
}

// Boards on a table lie at its height, face up.
TEST(BoardView, OnATableBoardsLieFaceUp) {
  std::vector<Isometry3> flanges;
  MatrixX joints(50, 1);
  for (Index i = 0; i < 50; ++i) {
    joints(i, 0) = 0.02 * static_cast<double>(i);
    flanges.push_back(rigid_motion(exp_so3(Vector3(3.0, 0.1, joints(i, 0))), Vector3(0.4, joints(i, 0), 0.6)));
  }
  const BoardPlaces found = propose_places(view, true, Isometry3::Identity(), flanges, joints, 1, 0.05);
  ASSERT_EQ(found.in_base.size(), 1u);
  EXPECT_NEAR(found.in_base[0](2, 3), 0.05, 1e-12);
  EXPECT_NEAR(found.in_base[0](2, 2), -1, 1e-12);
  EXPECT_NEAR(rotation(found.in_base[0]).determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace vernier::board_view_test
