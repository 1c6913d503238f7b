// SPDX-License-Identifier: BSD-3-Clause
// Standard deviations and covariances in files of poses.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"

namespace vn = vernier;

namespace covariance_columns_test {
namespace {

class CovarianceColumns : public ::testing::Test {
 protected:
  vn::Dataset<2> read(const std::string& text) {
    const std::string path = (folder_ / "poses.csv").string();
    std::ofstream(path) << text;
    return vn::read_dataset<2>(path);
  }
  vernier_test::TemporaryFolder folder_{"covariances"};
};

TEST_F(CovarianceColumns, OfStandardDeviationsAreDiagonal) {
  const vn::Dataset<2> poses = read("q1_rad,q2_rad,x_mm,y_mm,z_mm,sx_mm,sy_um,sz_m\n1,2,3,4,5,0.1,200,0.003\n");
  ASSERT_EQ(poses.covariances().size(), 1u);
  EXPECT_NEAR(poses.covariances()[0](0, 0), 1e-8, 1e-20);
  EXPECT_NEAR(poses.covariances()[0](1, 1), 4e-8, 1e-20);
  EXPECT_NEAR(poses.covariances()[0](2, 2), 9e-6, 1e-18);
  EXPECT_TRUE(read("q1_rad,q2_rad,x_mm,y_mm,z_mm\n1,2,3,4,5\n").covariances().empty());
}

TEST_F(CovarianceColumns, AreWrittenAndReadBack) {
  vn::Matrix6 one = vn::Matrix6::Identity() * 1e-8;
  one(0, 4) = one(4, 0) = 3e-9;
  vn::JointRows<2> joints(1, 2);
  joints << 0.1, 0.2;
  vn::PointRows positions(1, 3), orientations(1, 3);
  positions << 1, 2, 3;
  orientations << 0.1, 0.2, 0.3;
  const std::string path = (folder_ / "out.csv").string();
  vn::write_dataset(path, vn::Dataset<2>(joints, positions, orientations).with_covariances({one}));
  const vn::Dataset<2> back = vn::read_dataset<2>(path);
  ASSERT_EQ(back.covariances().size(), 1u);
  EXPECT_LT((back.covariances()[0] - one).cwiseAbs().maxCoeff(), 1e-22);
}

TEST_F(CovarianceColumns, WithMistakesAreRefused) {
  const auto complaint = [&](const std::string& text) { return vernier_test::complaint([&] { (void)read(text); }); };
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,sx_mm,sy_mm,sz_mm\n1,2,3,4,5,1,1,1\n1,2,3,4,5,1,0,1\n")
                .find("line 3, column sy_mm: a standard deviation must be positive"),
            std::string::npos);
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,sx_mm\n1,2,3,4,5,1\n").find("sx, sy and sz"), std::string::npos);
  std::string header = "q1_rad,q2_rad,x_mm,y_mm,z_mm", row = "1,2,3,4,5";
  for (int r = 1; r <= 6; ++r)
    for (int c = r; c <= 6; ++c) {
      header += ",cov_" + std::to_string(r) + std::to_string(c);
      row += r == c ? ",1" : r == 1 && c == 2 ? ",2" : ",0";
    }
  EXPECT_NE(complaint(header + "\n" + row + "\n").find("line 2, column cov_11: the covariance of this row is not"),
            std::string::npos);
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,cov_11\n1,2,3,4,5,1\n").find("21 columns"), std::string::npos);
}

TEST_F(CovarianceColumns, StandBesideOrientationsOfEachKind) {
  const std::string sigmas = ",sx_mm,sy_mm,sz_mm,srx_mrad,sry_mrad,srz_mrad\n", ones = ",1,1,1,1,1,1\n";
  const vn::Vector3 turn(0, 0, 1.5707963267948966);  // x to y
  for (const auto& [columns, values] : {std::pair{"rx_rad,ry_rad,rz_rad", "0,0,1.5707963267948966"},
                                        std::pair{"qw,qx,qy,qz", "0.7071067811865476,0,0,0.7071067811865476"},
                                        std::pair{"r11,r12,r13,r21,r22,r23,r31,r32,r33", "0,-1,0,1,0,0,0,0,1"}}) {
    const vn::Dataset<2> poses = read("q1_rad,q2_rad,x_mm,y_mm,z_mm," + std::string(columns) + sigmas + "1,2,3,4,5," +
                                      std::string(values) + ones);
    ASSERT_EQ(poses.orientations().rows(), 1) << columns;
    EXPECT_LT((vn::Vector3(poses.orientations().row(0).transpose()) - turn).norm(), 1e-12) << columns;
    EXPECT_NEAR(poses.covariances().at(0)(5, 5), 1e-6, 1e-18) << columns;
  }
}

TEST_F(CovarianceColumns, RefuseOrientationsThatAreNone) {
  const auto complaint = [&](const std::string& columns, const std::string& values) {
    return vernier_test::complaint(
        [&] { (void)read("q1_rad,q2_rad,x_mm,y_mm,z_mm," + columns + "\n1,2,3,4,5," + values + "\n"); });
  };
  EXPECT_NE(complaint("qw,qx,qy,qz", "1,1,0,0").find("line 2, column qw: a quaternion of norm 1.41"),
            std::string::npos);
  EXPECT_NE(complaint("qw,qx,qy", "1,0,0").find("qw, qx, qy and qz"), std::string::npos);
  EXPECT_NE(complaint("qw,qx,qy,qz,rx_rad,ry_rad,rz_rad", "1,0,0,0,0,0,0").find("both give an orientation"),
            std::string::npos);
  const std::string nine = "r11,r12,r13,r21,r22,r23,r31,r32,r33";
  EXPECT_NE(complaint(nine, "0,1,0,1,0,0,0,0,1").find("are no rotation matrix"), std::string::npos);  // a reflection
}

}  // namespace
}  // namespace covariance_columns_test
