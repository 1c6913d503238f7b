// SPDX-License-Identifier: BSD-3-Clause
// Euler angles in files of poses: their convention is declared, or they are refused.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/csv.hpp"

namespace vn = vernier;

namespace euler_columns_test {
namespace {

class EulerColumns : public ::testing::Test {
 protected:
  vn::Matrix3 orientation(const std::string& columns, const std::string& values, const std::string& euler) {
    const std::string path = folder_ / "poses.csv";
    std::ofstream(path) << "q1_rad,x_mm,y_mm,z_mm," + columns + "\n1,2,3,4," + values + "\n";
    vn::CsvFormat format;
    format.euler = euler;
    const auto data = vn::read_dataset<1>(path, {}, format);
    return data.has_orientations() ? data.orientation(0) : vn::Matrix3(vn::Matrix3::Zero());
  }
  std::string refused(const std::string& columns, const std::string& values, const std::string& euler) {
    const std::string said = vernier_test::complaint([&] { (void)orientation(columns, values, euler); });
    return said.substr(std::min(said.find("poses.csv"), said.size()));
  }
  vernier_test::TemporaryFolder folder_{"euler"};
};

constexpr double degree = 3.14159265358979323846 / 180;
const double A = 20 * degree, B = -50 * degree, C = 75 * degree;  // about z, y and x

/// Rz(a) Ry(b) Rx(c), as textbooks write it (Craig 2005, 2.64).
vn::Matrix3 textbook_zyx(double a, double b, double c) {
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cc = std::cos(c),
               sc = std::sin(c);
  vn::Matrix3 out;
  out << ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc,  //
      sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc,     //
      -sb, cb * sc, cb * cc;
  return out;
}

/// Rz(a) Ry(b) Rz(c) (Craig 2005, 2.72).
vn::Matrix3 textbook_zyz(double a, double b, double c) {
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cc = std::cos(c),
               sc = std::sin(c);
  vn::Matrix3 out;
  out << ca * cb * cc - sa * sc, -ca * cb * sc - sa * cc, ca * sb,  //
      sa * cb * cc + ca * sc, -sa * cb * sc + ca * cc, sa * sb,     //
      -sb * cc, sb * sc, cb;
  return out;
}

void expect_same(const vn::Matrix3& a, const vn::Matrix3& b) { EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-14) << a; }

TEST_F(EulerColumns, AboutTurnedAndFixedAxes) {
  const vn::Matrix3 zyx = textbook_zyx(A, B, C);
  expect_same(orientation("rx_deg,ry_deg,rz_deg", "75,-50,20", "ZYX"), zyx);
  expect_same(orientation("rz_deg,rx_deg,ry_deg", "20,75,-50", "xyz"), zyx);  // fixed axes, the other way round
  expect_same(orientation("euler1_deg,euler2_deg,euler3_deg", "20,-50,75", "ZYX"), zyx);
  expect_same(orientation("euler1_deg,euler2_deg,euler3_deg", "75,-50,20", "xyz"), zyx);
  expect_same(orientation("rx_deg,ry_deg,rz_deg", "75,-50,20", "XYZ"), textbook_zyx(-A, -B, -C).transpose());
  expect_same(orientation("euler1_deg,euler2_deg,euler3_deg", "20,-50,75", "ZYZ"), textbook_zyz(A, B, C));
}

TEST_F(EulerColumns, WithoutADeclarationAreARotationVectorOrRefused) {
  EXPECT_GT((orientation("rx_deg,ry_deg,rz_deg", "75,-50,20", "") - textbook_zyx(A, B, C)).cwiseAbs().maxCoeff(), 0.1);
  for (const char* columns :
       {"euler1_deg,euler2_deg,euler3_deg", "roll_deg,pitch_deg,yaw_deg", "a_deg,b_deg,c_deg", "w_deg,p_deg,r_deg"}) {
    const std::string said = refused(columns, "75,-50,20", "");
    EXPECT_NE(said.find("poses.csv, line 1: columns "), std::string::npos) << said;
    EXPECT_NE(said.find("state --euler ZYX"), std::string::npos) << said;
  }
}

TEST_F(EulerColumns, WithMistakesAreRefused) {
  EXPECT_NE(refused("rx_deg,ry_deg,rz_deg", "75,-50,20", "ZYZ").find("turn twice about one axis"), std::string::npos);
  EXPECT_NE(refused("qw,qx,qy,qz", "1,0,0,0", "ZYX").find("no Euler angles"), std::string::npos);
  EXPECT_NE(refused("note", "1", "ZYX").find("no Euler angles (--euler ZYX)"), std::string::npos);
  EXPECT_NE(refused("rx_deg,ry_deg", "1,2", "ZYX").find("no column rz"), std::string::npos);
  EXPECT_NE(refused("rx_deg,ry_deg,rz_deg,euler1_deg,euler2_deg,euler3_deg", "1,2,3,4,5,6", "ZYX")
                .find("rx_deg and euler1_deg both give"),
            std::string::npos);
  for (const char* order : {"ZZX", "ZyX", "abc", "ZY", "ZYXZ"})
    EXPECT_NE(vernier_test::complaint([&] {
                (void)orientation("rx_deg,ry_deg,rz_deg", "1,2,3", order);
              }).find("are no axes of Euler angles"),
              std::string::npos)
        << order;
}

}  // namespace
}  // namespace euler_columns_test
