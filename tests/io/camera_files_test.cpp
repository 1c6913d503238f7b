// SPDX-License-Identifier: BSD-3-Clause
// Boards and cameras as JSON files.

#include "vernier/io/camera_files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"

namespace vn = vernier;
using vernier_test::complaint;

namespace camera_files_test {
namespace {

class CameraFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& text) {
    const std::string path = (folder_ / "file.json").string();
    std::ofstream(path) << text;
    return path;
  }
  vernier_test::TemporaryFolder folder_{"camera_files"};
};

TEST_F(CameraFiles, OfBoardsHaveTheMeasuredScale) {
  const vn::Board board =
      vn::read_board(file(R"({"rows": 7, "columns": 5, "square_mm": 36, "marker_mm": 27, "dictionary": "DICT_5X5_250",
               "measured_mm": 216.6, "measured_squares": 6, "sigma_mm": 0.1})"));
  EXPECT_DOUBLE_EQ(board.square, 0.2166 / 6);
  EXPECT_DOUBLE_EQ(board.marker, 0.027 * board.square / 0.036);
  EXPECT_DOUBLE_EQ(board.scale_sigma, 0.1 / 216.6);
  EXPECT_EQ(board.corners(), 24);
  const vn::Board again = vn::read_board(file(vn::board_to_json(board).dump()));
  EXPECT_NEAR(again.square, board.square, 1e-15);
  EXPECT_NEAR(again.scale_sigma, board.scale_sigma, 1e-12);
  EXPECT_EQ(again.dictionary, board.dictionary);
  EXPECT_DOUBLE_EQ(vn::read_board(file(R"({"rows": 7, "columns": 5, "square_mm": 36})")).scale_sigma, 3e-3);
}

TEST_F(CameraFiles, OfBoardsWithMistakesAreRefused) {
  const auto complaint_of = [&](const std::string& text) {
    return complaint([&] { (void)vn::read_board(file(text)); });
  };
  EXPECT_NE(complaint_of(R"({"rows": 7, "columns": 5, "square_mm": 36, "measured_mm": 216, "sigma_mm": 1})")
                .find("state measured_squares"),
            std::string::npos);  // over 7 squares
  EXPECT_NE(complaint_of(R"({"rows": 7, "columns": 5, "square_mm": 36, "sigma_mm": 1})").find("measured_mm"),
            std::string::npos);
  EXPECT_NE(complaint_of(R"({"rows": 7, "columns": 5, "square_mm": 36, "marker_mm": 20})").find("belong together"),
            std::string::npos);
  EXPECT_NE(complaint_of(R"({"rows": 2, "columns": 5, "square_mm": 36})").find("rows"), std::string::npos);
}

TEST_F(CameraFiles, OfCamerasAreReadBack) {
  const std::string text = R"({"fx": 1352.5, "fy": 1356, "cx": 789.7, "cy": 627.3, "k1": -0.1, "p2": 1e-4,
                               "width": 1600, "height": 1200})";
  const vn::Camera camera = vn::read_camera_json(file(text));
  EXPECT_DOUBLE_EQ(camera.fx, 1352.5);
  EXPECT_DOUBLE_EQ(camera.p2, 1e-4);
  EXPECT_EQ(camera.width, 1600);
  EXPECT_EQ(vn::camera_to_json(vn::read_camera_json(file(vn::camera_to_json(camera).dump()))).dump(),
            vn::camera_to_json(camera).dump());
  EXPECT_NE(complaint([&] { (void)vn::read_camera_json(file(R"({"fx": 1, "fy": 1, "cx": 0})")); }).find("cy"),
            std::string::npos);
  EXPECT_NE(complaint([&] {
              (void)vn::read_camera_json(file(R"({"fx": 1, "fy": 1, "cx": 0, "cy": 0, "k4": 1})"));
            }).find("k4"),
            std::string::npos);
}

}  // namespace
}  // namespace camera_files_test
