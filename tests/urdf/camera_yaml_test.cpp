// SPDX-License-Identifier: BSD-3-Clause
// Cameras as OpenCV and ROS write them.

#include "vernier/urdf/camera_yaml.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"

namespace vn = vernier;

namespace camera_yaml_test {
namespace {

class CameraYaml : public ::testing::Test {
 protected:
  vn::Camera read(const std::string& text) {
    const std::string path = (folder_ / "camera.yaml").string();
    std::ofstream(path) << text;
    return vn::read_camera_yaml(path);
  }
  std::string complaint(const std::string& text) {
    return vernier_test::complaint([&] { (void)read(text); });
  }
  vernier_test::TemporaryFolder folder_{"camera_yaml"};
};

const std::string ros = R"(image_width: 640
image_height: 480
camera_name: prosilica
camera_matrix: {rows: 3, cols: 3, data: [455.0, 0, 320.5, 0, 456.25, 240.5, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.25, 0.06, 0.001, -0.002, 0.003]
)";

TEST_F(CameraYaml, OfRosIsRead) {
  const vn::Camera camera = read(ros);
  const double expected[] = {455, 456.25, 320.5, 240.5, -0.25, 0.06, 0.001, -0.002, 0.003};
  for (vn::Index k = 0; k < 9; ++k) EXPECT_DOUBLE_EQ(camera.parameters()(k), expected[k]) << k;
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
}

TEST_F(CameraYaml, OfOpenCvIsRead) {
  const vn::Camera camera = read(R"(%YAML:1.0
---
image_width: 1600
image_height: 1200
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1.352e+03, 0., 7.897e+02, 0., 1.356e+03, 6.273e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 4
   cols: 1
   dt: d
   data: [ -1.5e-01, 8.e-02, 0., 1.e-04 ]
)");
  EXPECT_DOUBLE_EQ(camera.fx, 1352);
  EXPECT_DOUBLE_EQ(camera.cy, 627.3);
  EXPECT_DOUBLE_EQ(camera.k2, 0.08);
  EXPECT_DOUBLE_EQ(camera.p2, 1e-4);
}

TEST_F(CameraYaml, OfAnotherModelIsRefusedByName) {
  std::string text = ros;
  text.replace(text.find("plumb_bob"), 9, "rational_polynomial");
  EXPECT_NE(complaint(text).find("line 5: distortion_model is 'rational_polynomial'"), std::string::npos);
  text = ros;
  text.replace(text.find("0.003]"), 6, "0.003, 0.1, 0, 0]");
  EXPECT_NE(complaint(text).find("has 8 numbers, of another model"), std::string::npos);
  text = ros;
  text.replace(text.find("455.0, 0,"), 9, "455.0, 2,");
  EXPECT_NE(complaint(text).find("without skew"), std::string::npos);
  EXPECT_NE(complaint("camera_matrix: [1").find("not valid YAML"), std::string::npos);
  EXPECT_NE(complaint("image_width: 3").find("'camera_matrix' is missing"), std::string::npos);
}

}  // namespace
}  // namespace camera_yaml_test
