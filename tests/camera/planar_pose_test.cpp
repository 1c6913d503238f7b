// SPDX-License-Identifier: BSD-3-Clause
// Poses of a board from single images, and cameras from several.

#include "vernier/camera/planar_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "projection.hpp"

namespace vn = vernier;
using vernier_test::board_before_camera;
using vernier_test::machine_camera;
using vernier_test::view_of;

namespace planar_pose_test {
namespace {

const vn::Board board{.rows = 7, .columns = 5, .square = 0.036};

double apart(const vn::Isometry3& a, const vn::Isometry3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

TEST(BoardPoses, OfExactPixelsAreExact) {
  vn::Rng rng(3);
  for (int trial = 0; trial < 50; ++trial) {
    const vn::Isometry3 truth = board_before_camera(board, 0.7, rng);
    const vn::View view = view_of(machine_camera(), board, truth, 0, rng);
    ASSERT_GE(view.corners.size(), 4u);
    const auto poses = vn::board_poses(machine_camera(), board, view.corners, view.pixels);
    EXPECT_LT(poses[0].rms, 1e-8);
    EXPECT_LT(apart(poses[0].camera_T_board, truth), 1e-8);
  }
}

TEST(BoardPoses, OfASmallDistantBoardHaveTheTruthAmongThem) {
  vn::Rng rng(4);
  const vn::Board little{.rows = 4, .columns = 4, .square = 0.01};
  int second = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const vn::Isometry3 truth = board_before_camera(little, 2, rng);
    const vn::View view = view_of(machine_camera(), little, truth, 0.2, rng);
    const auto poses = vn::board_poses(machine_camera(), little, view.corners, view.pixels);
    const auto turned_by = [&](const vn::BoardPose& pose) {
      const vn::Matrix3 turn = pose.camera_T_board.linear() * truth.linear().transpose();
      return vn::log_so3(turn).norm();
    };
    EXPECT_LT((std::min)(turned_by(poses[0]), turned_by(poses[1])), 0.5) << trial;
    if (turned_by(poses[1]) < turned_by(poses[0])) ++second;
  }
  EXPECT_GT(second, 5);  // the better fit is not always the right one
}

TEST(Homography, TakesPointsOfThePlaneToPointsSeen) {
  vn::Matrix3 truth;
  truth << 900, 20, 300, -30, 1100, 200, 0.1, -0.2, 1;
  std::vector<vn::Vector2> plane, seen;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.1, 0.0}, {0.0, 0.2}, {0.3, 0.3}, {0.2, 0.05}}) {
    plane.emplace_back(x, y);
    const vn::Vector3 q = truth * vn::Vector3(x, y, 1);
    seen.emplace_back(q(0) / q(2), q(1) / q(2));
  }
  EXPECT_LT((vn::homography(plane, seen) - truth).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(CameraFromHomographies, IsThePinholeThatTookTheImages) {
  vn::Camera pinhole = machine_camera();
  pinhole.k1 = pinhole.k2 = pinhole.p1 = pinhole.p2 = 0;
  vn::Rng rng(5);
  std::vector<vn::Matrix3> homographies;
  for (int k = 0; k < 8; ++k) {
    const vn::View view = view_of(pinhole, board, board_before_camera(board, 0.7, rng), 0, rng);
    std::vector<vn::Vector2> plane;
    for (const vn::Index corner : view.corners) plane.emplace_back(board.corner(corner)(0), board.corner(corner)(1));
    homographies.push_back(vn::homography(plane, view.pixels));
  }
  const vn::Camera found = vn::camera_from_homographies(homographies);
  EXPECT_NEAR(found.fx, pinhole.fx, 1e-4);
  EXPECT_NEAR(found.fy, pinhole.fy, 1e-4);
  EXPECT_NEAR(found.cx, pinhole.cx, 1e-4);
  EXPECT_NEAR(found.cy, pinhole.cy, 1e-4);
  EXPECT_LE(vn::camera_from_homographies({homographies.data(), 2}).fx, 0);  // two are too few
}

}  // namespace
}  // namespace planar_pose_test
