// SPDX-License-Identifier: BSD-3-Clause
// Images of virtual arms, against a projection that shares no code with the library's.
#include "vernier/simulation/views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "complaint.hpp"
#include "projection.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/rigid_motions.hpp"

namespace vernier::views_test {
namespace {

const Board board{.rows = 6, .columns = 9, .square = 0.03};

Isometry3 frame(double x, double y, double z, double rx, double ry, double rz) {
  return rigid_motion(exp_so3(Vector3(rx, ry, rz)), Vector3(x, y, z));
}

/// Camera or board at the flange, two of the other in the base.
CameraSetup setup_of(bool on_flange) {
  CameraSetup out{.on_flange = on_flange, .board = board};
  const Camera first = vernier_test::machine_camera();
  Camera second = first;
  second.fx = 900;
  const std::vector<Isometry3> standing{frame(0.5, -0.1, 0.2, 0, 0, 0.3), frame(0.6, 0.2, 0.1, 0.2, 0, -0.4)};
  out.cameras = on_flange ? std::vector<Camera>{first} : std::vector<Camera>{first, second};
  out.camera_names = on_flange ? std::vector<std::string>{"wrist"} : std::vector<std::string>{"left", "right"};
  out.board_names = on_flange ? std::vector<std::string>{"near", "far"} : std::vector<std::string>{"board"};
  out.in_base = standing;
  out.in_flange = {frame(0.05, 0.03, 0.06, 0.15, -0.1, 0.4)};
  return out;
}

/// A flange from which the image of a setup shows the board well.
Isometry3 facing(const CameraSetup& setup, std::size_t standing, Rng& rng) {
  const Isometry3 camera_T_board = vernier_test::board_before_camera(board, 0.6, rng);
  return setup.on_flange ? Isometry3(setup.in_base[standing] * camera_T_board.inverse() * setup.in_flange[0].inverse())
                         : Isometry3(setup.in_base[standing] * camera_T_board * setup.in_flange[0].inverse());
}

class ViewsOf : public ::testing::TestWithParam<bool> {};

TEST_P(ViewsOf, VirtualArmsHaveCornersWhereTheyAre) {
  const CameraSetup setup = setup_of(GetParam());
  Rng rng(2);
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < 8; ++i)
    shots.push_back({facing(setup, i % 2, rng), GetParam() ? 0 : static_cast<Index>(i % 2),
                     GetParam() ? static_cast<Index>(i % 2) : 0});
  const CornerViews views = simulate_views(setup, shots, 0, 1);
  ASSERT_EQ(views.views.size(), 8u);
  Index seen = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const View& view = views.views[i];
    EXPECT_EQ(view.image, "image" + std::to_string(i + 1) + ".png");
    EXPECT_EQ(view.camera, shots[i].camera);
    EXPECT_EQ(view.board, shots[i].board);
    const Isometry3 carried = shots[i].flange * setup.in_flange[0];
    const Isometry3 camera_T_board = GetParam() ? Isometry3(carried.inverse() * setup.in_base[i % 2])
                                                : Isometry3(setup.in_base[i % 2].inverse() * carried);
    const Camera& camera = setup.cameras[static_cast<std::size_t>(view.camera)];
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      const Vector2 truth = vernier_test::seen_at(camera, camera_T_board * board.corner(view.corners[k]));
      EXPECT_LT((view.pixels[k] - truth).norm(), 1e-9);
      ++seen;
    }
    EXPECT_EQ(view.width, 1600);
    EXPECT_EQ(view.height, 1200);
  }
  EXPECT_GT(seen, 6 * board.corners());
  EXPECT_EQ(seen, views.corners());
}

INSTANTIATE_TEST_SUITE_P(BothMounts, ViewsOf, ::testing::Bool());

TEST(SeenView, HasTheStatedNoise) {
  const Isometry3 before = frame(-0.13, -0.08, 0.5, 0.1, -0.2, 0);
  Rng rng(3), other(4);
  double sum = 0;
  Index count = 0;
  for (int image = 0; image < 100; ++image) {
    const View noisy = seen_view(vernier_test::machine_camera(), board, before, 0.3, rng),
               exact = seen_view(vernier_test::machine_camera(), board, before, 0, other);
    ASSERT_EQ(noisy.corners, exact.corners);
    for (std::size_t k = 0; k < noisy.pixels.size(); ++k, count += 2)
      sum += (noisy.pixels[k] - exact.pixels[k]).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(count)), 0.3, 0.3 * 4 / std::sqrt(2.0 * static_cast<double>(count)));
}

TEST(SeenView, LacksCornersBeyondTheImageBehindTheCameraAndOnTheBack) {
  const Camera camera = vernier_test::machine_camera();
  Rng rng(1);
  const auto corners = [&](const Isometry3& camera_T_board) {
    return static_cast<Index>(seen_view(camera, board, camera_T_board, 0, rng).corners.size());
  };
  const double x = -board.middle().x(), y = -board.middle().y();
  EXPECT_EQ(corners(frame(x, y, 0.4, 0, 0, 0)), board.corners());
  EXPECT_EQ(corners(frame(x, y, -0.4, 0, 0, 0)), 0);       // behind
  EXPECT_EQ(corners(frame(-x, y, 0.4, 0, 3.1415, 0)), 0);  // its back
  const Index part = corners(frame(0, y, 0.4, 0, 0, 0));   // half of it leaves the image
  EXPECT_GT(part, 0);
  EXPECT_LT(part, board.corners());
  Camera folded = camera;  // x (1 - 0.5 x^2) turns back at x = 0.82: at 1.3 it is 0.2 again
  folded.k1 = -0.5;
  folded.k2 = folded.p1 = folded.p2 = 0;
  EXPECT_EQ(seen_view(folded, board, frame(0.55, y, 0.45, 0, 0, 0), 0, rng).corners.size(), 0u);
  EXPECT_EQ(
      vernier_test::complaint([&] { (void)seen_view({.fx = 1, .fy = 1}, board, frame(0, 0, 1, 0, 0, 0), 0, rng); }),
      "seen_view: the size of the camera's images is unknown");
}

TEST(SimulateViews, RefusesPlacesThatAreNotThere) {
  CameraSetup setup = setup_of(true);
  const std::vector<Shot> shots{{Isometry3::Identity(), 0, 2}};
  EXPECT_EQ(vernier_test::complaint([&] { (void)simulate_views(setup, shots, 0, 1); }),
            "simulate_views: image 1 is of camera 0 and place 2, of 1 and 2");
  setup.board_names.pop_back();
  EXPECT_NE(
      vernier_test::complaint([&] { (void)simulate_views(setup, shots, 0, 1); }).find("2 places of the board with 1"),
      std::string::npos);
}

TEST(CornersText, IsReadBack) {
  const vernier_test::TemporaryFolder folder("corners_text");
  const std::string file = (folder / "corners.csv").string();
  for (const bool on_flange : {true, false}) {
    CameraSetup setup = setup_of(on_flange);
    if (!on_flange) {  // names that need no column
      setup.cameras.pop_back();
      setup.in_base.pop_back();
      setup.camera_names = {"camera"};
    }
    Rng rng(5);
    std::vector<Shot> shots;
    for (std::size_t i = 0; i < 4; ++i)
      shots.push_back({facing(setup, on_flange ? i % 2 : 0, rng), 0, on_flange ? static_cast<Index>(i % 2) : 0});
    const CornerViews views = simulate_views(setup, shots, 0.2, 1);
    write_file(file, corners_text(views));
    const CornerViews read = read_corners(file, board);
    EXPECT_EQ(read.cameras, views.cameras);
    EXPECT_EQ(read.boards, views.boards);
    ASSERT_EQ(read.views.size(), views.views.size());
    for (std::size_t i = 0; i < read.views.size(); ++i) {
      EXPECT_EQ(read.views[i].image, views.views[i].image);
      EXPECT_EQ(read.views[i].board, views.views[i].board);
      EXPECT_EQ(read.views[i].corners, views.views[i].corners);
      EXPECT_EQ(read.views[i].width, views.views[i].width);
      for (std::size_t k = 0; k < read.views[i].pixels.size(); ++k)
        EXPECT_LT((read.views[i].pixels[k] - views.views[i].pixels[k]).lpNorm<Eigen::Infinity>(), 0.51e-4);
    }
    EXPECT_EQ(corners_text(read), corners_text(views));
  }
  View unsized{"a.png"};
  unsized.corners = {3};
  unsized.pixels = {Vector2(1.5, 2)};
  CornerViews one;
  one.views = {unsized};
  EXPECT_EQ(corners_text(one), "image,corner,u_px,v_px\na.png,3,1.5,2\n");
  for (const char* name : {"a,b.png", "", "a\"b", "a\n"}) {
    one.views[0].image = name;
    EXPECT_NE(vernier_test::complaint([&] { (void)corners_text(one); }).find("cannot stand in a CSV file"),
              std::string::npos);
  }
}

TEST(ImageJointsText, IsReadBack) {
  const vernier_test::TemporaryFolder folder("image_joints_text");
  const std::string file = (folder / "joints.csv").string();
  ImageRows rows{.images = {"a.png", "b.png"}, .joints = MatrixX(2, 2)};
  rows.joints << 0.25, -1.0 / 3, 1e-9, 2;
  const std::vector<JointType> types{JointType::prismatic, JointType::revolute};
  const std::string text = image_joints_text(rows, types);
  EXPECT_EQ(text.substr(0, text.find('\n')), "image,q1_m,q2_rad");
  write_file(file, text);
  const ImageRows read = read_image_joints(file, 2, types);
  EXPECT_EQ(read.images, rows.images);
  EXPECT_EQ(read.joints, rows.joints);
  rows.images.pop_back();
  EXPECT_EQ(vernier_test::complaint([&] { (void)image_joints_text(rows); }),
            "image_joints_text: 1 images, 2 rows of 2 joints, 0 types");
}

}  // namespace
}  // namespace vernier::views_test
