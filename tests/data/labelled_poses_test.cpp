// SPDX-License-Identifier: BSD-3-Clause
// Poses with whole numbers beside them, read from files.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "temporary_folder.hpp"
#include "vernier/core/so3.hpp"
#include "vernier/data/csv.hpp"

namespace labelled_poses_test {
namespace {

using namespace vernier;

class ReadLabelledPoses : public ::testing::Test {
 protected:
  LabelledPoses read(const std::string& text) {
    write_file(folder_ / "p.csv", text);
    return read_labelled_poses(folder_ / "p.csv", {"pose", "cycle"}, {"direction"});
  }
  std::string refused(const std::string& text) {
    try {
      (void)read(text);
    } catch (const DataError& e) {
      const std::string what = e.what();
      return what.substr(what.find("p.csv"));
    }
    return {};
  }
  vernier_test::TemporaryFolder folder_{"labelled_poses"};
};

TEST_F(ReadLabelledPoses, AllColumns) {
  const LabelledPoses out = read(
      "cycle,pose,direction,time_s,x_mm,y_m,z_um,rx_deg,ry_rad,rz_mrad\n2,1,3,0.5,1,2,3,90,0,0\n4,5,0,1,0,0,0,0,0,1\n");
  EXPECT_EQ(out.labels, (Eigen::MatrixXi(2, 3) << 1, 2, 3, 5, 4, 0).finished());
  EXPECT_EQ(out.times, Eigen::Vector2d(0.5, 1));
  EXPECT_TRUE(out.oriented);
  ASSERT_EQ(out.poses.size(), 2u);
  EXPECT_LT((out.poses[0].translation() - Vector3(1e-3, 2, 3e-6)).norm(), 1e-15);
  EXPECT_LT((out.poses[0].linear() - exp_so3(Vector3(std::numbers::pi / 2, 0, 0))).norm(), 1e-15);
  EXPECT_LT((out.poses[1].linear() - exp_so3(Vector3(0, 0, 1e-3))).norm(), 1e-15);
}

TEST_F(ReadLabelledPoses, OptionalColumns) {
  const LabelledPoses out = read("pose,cycle,x_mm,y_mm,z_mm\n1,2,3,4,5\n");
  EXPECT_EQ(out.labels, (Eigen::MatrixXi(1, 3) << 1, 2, 0).finished());
  EXPECT_TRUE(std::isnan(out.times(0)));
  EXPECT_FALSE(out.oriented);
  EXPECT_EQ(out.poses[0].linear(), Matrix3::Identity());
}

TEST_F(ReadLabelledPoses, Refusals) {
  EXPECT_EQ(refused("pose,x_mm,y_mm,z_mm\n1,2,3,4\n"),
            "p.csv, line 1: no column cycle in the header (pose, x_mm, y_mm, z_mm)");
  EXPECT_EQ(refused("pose,cycle,x_mm,y_mm,z_mm\n1,2,3,4,5\n1,2.5,3,4,5\n"),
            "p.csv, line 3, column cycle: 2.5, must be a whole number");
  EXPECT_EQ(refused("pose,cycle,x_mm,y_mm,z_mm,rx_rad\n1,2,3,4,5,6\n"),
            "p.csv, line 1: no column ry_rad or ry_deg in the header (pose, cycle, x_mm, y_mm, z_mm, rx_rad)");
  EXPECT_EQ(refused("pose,cycle,x_mm,y_mm,z_mm\n"), "p.csv: a header, but no rows of data");
  EXPECT_EQ(refused("pose,cycle,x_mm,y_mm,z_mm\n1,a,3,4,5\n"), "p.csv, line 2, column cycle: 'a' is not a number");
}

}  // namespace
}  // namespace labelled_poses_test
