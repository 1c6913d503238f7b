// SPDX-License-Identifier: BSD-3-Clause
// Files of corners, and the joints or poses of their images.

#include "vernier/camera/corner_views.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/data_error.hpp"

namespace vn = vernier;
using vernier_test::complaint;

namespace corner_views_test {
namespace {

const vn::Board board{.rows = 4, .columns = 3, .square = 0.03};

class CornerFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  vernier_test::TemporaryFolder folder_{"corners"};
};

TEST_F(CornerFiles, AreReadImageByImage) {
  const vn::CornerViews views = vn::read_corners(
      file("c.csv",
           "image,corner,board_x_mm,board_y_mm,u_px,v_px,camera,width_px,height_px\n"
           "b.png,0,30,30,10.5,20.25,left,640,480\na.png,5,60,90,1,2,right,640,480\nb.png,3,60,60,3,4,left,640,480\n"),
      board);
  ASSERT_EQ(views.views.size(), 2u);
  EXPECT_EQ(views.corners(), 3);
  EXPECT_EQ(views.cameras, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(views.views[0].image, "b.png");
  EXPECT_EQ(views.views[0].corners, (std::vector<vn::Index>{0, 3}));
  EXPECT_EQ(views.views[0].pixels[0], vn::Vector2(10.5, 20.25));
  EXPECT_EQ(views.views[0].width, 640);
  EXPECT_EQ(views.views[1].camera, 1);
  EXPECT_EQ(views.views[1].line, 3);
}

TEST_F(CornerFiles, WithMistakesAreRefusedByLine) {
  const auto complaint_of = [&](const std::string& rows) {
    return complaint([&] { (void)vn::read_corners(file("c.csv", "image,corner,u_px,v_px\n" + rows), board); });
  };
  EXPECT_NE(complaint_of("a,6,1,2\n").find("line 2, column corner: the board has corners 0 to 5, not 6"),
            std::string::npos);
  EXPECT_NE(complaint_of("a,1.5,1,2\n").find("1.5 is no whole number"), std::string::npos);
  EXPECT_NE(complaint_of("a,1,1,2\na,1,1,3\n").find("line 3, column corner: corner 1 of image 'a' is there twice"),
            std::string::npos);
  EXPECT_NE(complaint_of("a,1,x,2\n").find("column u_px"), std::string::npos);
  EXPECT_NE(complaint([&] {
              (void)vn::read_corners(file("d.csv", "image,corner,board_x_mm,board_y_mm,u_px,v_px\na,0,30,36,1,2\n"),
                                     board);
            }).find("corner 0 is 6"),
            std::string::npos);
}

TEST_F(CornerFiles, MatchRowsByTheNameOfTheImage) {
  const vn::CornerViews views =
      vn::read_corners(file("c.csv", "image,corner,u_px,v_px\na,0,1,2\nb,0,1,2\nc,0,1,2\n"), board);
  const vn::ImageRows rows = vn::read_image_joints(file("q.csv", "image,q1_rad,q2_rad\nc,1,2\nd,3,4\na,5,6\n"), 2);
  const vn::MatchedViews matched = vn::match_images(views, rows);
  EXPECT_EQ(matched.views, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(matched.rows, (std::vector<vn::Index>{2, 0}));
  EXPECT_EQ(matched.without_row, std::vector<std::string>{"b"});
  EXPECT_EQ(matched.without_corners, std::vector<std::string>{"d"});
  EXPECT_DOUBLE_EQ(rows.joints(2, 1), 6);
  const vn::ImageRows others = vn::read_image_joints(file("r.csv", "image,q1_rad,q2_rad\nx,1,2\n"), 2);
  EXPECT_NE(complaint([&] { (void)vn::match_images(views, others); }).find("'a' is here, 'x' is there"),
            std::string::npos);
}

TEST_F(CornerFiles, HavePosesOfTheFlange) {
  const vn::ImageRows rows = vn::read_flange_poses(
      file("f.csv", "image,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\na,100,200,300,0,0,1.5707963267948966\n"));
  ASSERT_EQ(rows.size(), 1);
  EXPECT_LT((rows.flanges[0] * vn::Vector3(1, 0, 0) - vn::Vector3(0.1, 1.2, 0.3)).norm(), 1e-12);
  EXPECT_NE(complaint([&] {
              (void)vn::read_flange_poses(
                  file("g.csv", "image,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\na,1,2,3,0,0,0\na,1,2,3,0,0,0\n"));
            }).find("'a' is also in line 2"),
            std::string::npos);
}

}  // namespace
}  // namespace corner_views_test
