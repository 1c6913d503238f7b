// SPDX-License-Identifier: BSD-3-Clause
// Corners that are found in rendered images, and boards of ours against those that OpenCV draws.

#include "board_detection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "complaint.hpp"
#include "projection.hpp"
#include "rendered_board.hpp"
#include "vernier/camera/board_svg.hpp"

namespace vn = vernier;

namespace board_detection_test {
namespace {

/// Lengths are multiples of a 24th of a square, so a raster of 24 a square is exact.
vn::Board charuco() { return {.rows = 7, .columns = 5, .square = 0.024, .marker = 0.018, .dictionary = "DICT_4X4_50"}; }

vn::Camera small_camera() {
  vn::Camera out{.fx = 700, .fy = 705, .cx = 325, .cy = 236, .k1 = -0.1, .k2 = 0.05, .p1 = 3e-4, .p2 = -4e-4};
  out.width = 640;
  out.height = 480;
  return out;
}

struct Deviation {
  double bias_u = 0, bias_v = 0, rms_u = 0, rms_v = 0;
  int corners = 0, missed = 0;
};

/// Corners as they are found, against those that an independent account projects.
Deviation deviation(const vn::Board& board, int images, double half_pixel) {
  Deviation out;
  vn::Rng rng(3);
  for (int image = 0; image < images; ++image) {
    const vn::Vector3 turn(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.4, 0.4));
    const vn::Matrix3 rotation = vn::exp_so3(turn);
    const vn::Isometry3 pose = vn::rigid_motion(
        rotation, vn::Vector3(rng.uniform(-0.01, 0.01), rng.uniform(-0.01, 0.01), 0.27) - rotation * board.middle());
    const vn::View found =
        support::detect_board(board, vernier_test::rendered(board, small_camera(), pose, half_pixel, rng),
                              small_camera().width, small_camera().height);
    out.missed += static_cast<int>(board.corners()) - static_cast<int>(found.corners.size());
    for (std::size_t i = 0; i < found.corners.size(); ++i) {
      const vn::Vector2 truth = vernier_test::seen_at(small_camera(), pose * board.corner(found.corners[i]));
      const double u = found.pixels[i](0) - truth(0), v = found.pixels[i](1) - truth(1);
      out.bias_u += u;
      out.bias_v += v;
      out.rms_u += u * u;
      out.rms_v += v * v;
      ++out.corners;
    }
  }
  const double n = (std::max)(1, out.corners);
  return {out.bias_u / n, out.bias_v / n, std::sqrt(out.rms_u / n), std::sqrt(out.rms_v / n), out.corners, out.missed};
}

TEST(DetectedCorners, OfARenderedChArUcoBoardAreWhereTheyAre) {
  const Deviation found = deviation(charuco(), 5, 0);
  EXPECT_GT(found.corners, 90);
  EXPECT_NEAR(found.bias_u, 0, 0.01);
  EXPECT_NEAR(found.bias_v, 0, 0.01);
  EXPECT_LT(found.rms_u, 0.05);
  EXPECT_LT(found.rms_v, 0.05);
}

TEST(DetectedCorners, OfARenderedChessboardAreWhereTheyAre) {
  vn::Board board{.rows = 7, .columns = 6, .square = 0.024};
  const Deviation found = deviation(board, 5, 0);
  EXPECT_GT(found.corners, 90);
  EXPECT_NEAR(found.bias_u, 0, 0.01);
  EXPECT_NEAR(found.bias_v, 0, 0.01);
  EXPECT_LT(found.rms_u, 0.05);
  EXPECT_LT(found.rms_v, 0.05);
}

TEST(DetectedCorners, ShowHalfAPixelThatIsPlantedInTheRenderer) {
  EXPECT_NEAR(deviation(charuco(), 1, 0.5).bias_u, -0.5, 0.03);
}

TEST(DetectedCorners, DoNotExistWithoutABoard) {
  EXPECT_TRUE(support::detect_board(charuco(), std::vector<unsigned char>(640 * 480, 200), 640, 480).corners.empty());
  const vn::Board symmetric{.rows = 6, .columns = 8, .square = 0.024};
  EXPECT_NE(vernier_test::complaint([&] {
              (void)support::detect_board(symmetric, std::vector<unsigned char>(640 * 480, 200), 640, 480);
            }).find("looks the same after half a turn"),
            std::string::npos);
}

TEST(PrintedBoard, IsTheOneThatOpenCvDraws) {
  for (const char* dictionary : {"DICT_4X4_250", "DICT_5X5_250"}) {
    const bool four = dictionary[5] == '4';
    vn::Board board{.rows = 22, .columns = 21, .square = four ? 0.024 : 0.028, .dictionary = dictionary};
    board.marker = four ? 0.018 : 0.021;  // cells of 3 raster units
    const int per_square = four ? 24 : 28;
    const std::vector<unsigned char> drawn = support::drawn_by_opencv(board, per_square);
    const int width = static_cast<int>(board.columns) * per_square;
    int wrong = 0;
    for (int r = 0; r < static_cast<int>(board.rows) * per_square; ++r)
      for (int c = 0; c < width; ++c) {
        // OpenCV rounds the place of a marker to whole pixels: its outline is not compared
        const int in_row = r % per_square, in_column = c % per_square, unit = 3;
        const int margin = (per_square - (four ? 18 : 21)) / 2;
        if ((in_row - margin + 30 * unit) % unit != 1 || (in_column - margin + 30 * unit) % unit != 1) continue;
        const bool ours = vn::is_black(board, (c + 0.5) * 1e-3, (r + 0.5) * 1e-3);
        wrong += ours != (drawn[static_cast<std::size_t>(r * width + c)] < 128) ? 1 : 0;
      }
    EXPECT_EQ(wrong, 0) << dictionary;
  }
}

}  // namespace
}  // namespace board_detection_test
