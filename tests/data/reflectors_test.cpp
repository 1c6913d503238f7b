// SPDX-License-Identifier: BSD-3-Clause
// Several reflectors in one file: a column that names them, or all of them in one line.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/data/reflectors.hpp"

namespace vn = vernier;

namespace reflectors_test {
namespace {

class Reflectors : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const {
    const std::string path = folder_ / "poses.csv";
    std::ofstream(path) << text;
    return path;
  }
  std::vector<vn::ReflectorPoses<1>> read(const std::string& text) const {
    return vn::read_reflectors<1>(file(text), {}, format_);
  }
  std::string refused(const std::string& text) const {
    const std::string said = vernier_test::complaint([&] { (void)read(text); });
    return said.substr(std::min(said.find("poses.csv"), said.size()));
  }
  vernier_test::TemporaryFolder folder_{"reflectors"};
  mutable std::string remarks_{};
  vn::CsvFormat format_{.remark = [this](const std::string& line) { remarks_ += line; }};
};

TEST_F(Reflectors, InTurnAreNamedByAColumn) {
  const auto found = read(
      "point,q1_rad,x_mm,y_mm,z_mm\nleft,1,10,0,0\nright,2,20,0,0\nleft,3,30,0,0\nright,4,40,0,0\nleft,5,50,0,0\n"
      "right,6,60,0,0\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].point, "left");
  EXPECT_EQ(found[1].point, "right");
  ASSERT_EQ(found[1].poses.size(), 3);
  EXPECT_DOUBLE_EQ(found[1].poses.positions()(2, 0), 0.06);
  EXPECT_EQ(found[1].poses.origin().line, (std::vector<vn::Index>{3, 5, 7}));
  EXPECT_DOUBLE_EQ(found[1].poses.previous()(1, 0), 3);  // the row before, whichever reflector it measured
  EXPECT_DOUBLE_EQ(found[1].poses.times()(1), 3);
}

TEST_F(Reflectors, OfOneVisitWereApproachedFromTheSameConfiguration) {
  const auto found =
      read("point,q1_rad,x_mm,y_mm,z_mm\n1,1,0,0,0\n2,1,0,0,0\n1,2,0,0,0\n2,2,0,0,0\n1,4,0,0,0\n2,4,0,0,0\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(std::isnan(found[1].poses.previous()(0, 0)));
  EXPECT_DOUBLE_EQ(found[1].poses.previous()(1, 0), 1);
  EXPECT_DOUBLE_EQ(found[1].poses.previous()(2, 0), 2);
}

TEST_F(Reflectors, OfALineAreSeveralRows) {
  const auto found = read(
      "q1_rad,x1_mm,y1_mm,z1_mm,x2_m,y2_m,z2_m,sx_mm,sy_mm,sz_mm,time_s\n1,1,2,3,4,5,6,.1,.1,.1,10\n"
      "2,7,8,9,,,,.2,.2,.2,20\n3,1,1,1,2,2,2,.1,.1,.1,30\n4,1,1,1,2,2,2,.1,.1,.1,40\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].poses.size(), 4);
  ASSERT_EQ(found[1].poses.size(), 3);  // the empty cells were not seen
  EXPECT_EQ(found[1].point, "2");
  EXPECT_DOUBLE_EQ(found[1].poses.positions()(0, 2), 6);
  EXPECT_DOUBLE_EQ(found[1].poses.joints()(1, 0), 3);
  EXPECT_DOUBLE_EQ(found[1].poses.previous()(1, 0), 2);
  EXPECT_DOUBLE_EQ(found[1].poses.times()(1), 30);
  EXPECT_EQ(found[1].poses.origin().line, (std::vector<vn::Index>{2, 4, 5}));
  EXPECT_NEAR(found[0].poses.covariances()[1](0, 0), 4e-8, 1e-20);
}

TEST_F(Reflectors, AreOneWithoutNames) {
  const auto found = read("q1_rad,x_mm,y_mm,z_mm\n1,1,2,3\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].point, "");
}

TEST_F(Reflectors, AreNotNamesOfPoses) {
  const auto found = read("point,q1_rad,x_mm,y_mm,z_mm\nP1,1,0,0,0\nP2,2,0,0,0\nP1,1,0,0,0\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].poses.size(), 3);
  EXPECT_NE(remarks_.find("the column point names poses"), std::string::npos) << remarks_;
  // encoders show other last digits at the same pose
  remarks_.clear();
  EXPECT_EQ(read("point,q1_rad,x_mm,y_mm,z_mm\nP1,1,0,0,0\nP2,2,0,0,0\nP1,1.00003,0,0,0\n").size(), 1u);
  EXPECT_NE(remarks_.find("the column point names poses"), std::string::npos) << remarks_;
}

TEST_F(Reflectors, WithMistakesAreRefused) {
  const std::string head = "point,q1_rad,x_mm,y_mm,z_mm\n";
  EXPECT_EQ(refused(head + "a,1,0,0,0\na,2,0,0,0\na,3,0,0,0\nb,1,0,0,0\n"),
            "poses.csv, line 1: the reflector 'b' is measured at 1 configuration, it needs three or more; call the "
            "column otherwise if it names no reflectors");
  EXPECT_NE(refused(head + "a,1,0,0,0\n,2,0,0,0\n").find("line 3, column point: no name"), std::string::npos);
  EXPECT_NE(refused("q1_rad,x1_mm,y1_mm,z1_mm,x2_mm,y2_mm,z2_mm\n1,1,2,3,4,,6\n").find("three empty cells"),
            std::string::npos);
  EXPECT_NE(refused("q1_rad,x1_mm,y1_mm,z1_mm,x3_mm,y3_mm,z3_mm\n1,1,2,3,4,5,6\n").find("x3_mm, but no x2"),
            std::string::npos);
  EXPECT_NE(refused("point,q1_rad,x1_mm,y1_mm,z1_mm\na,1,1,2,3\n").find("exclude"), std::string::npos);
  std::string oriented = "point,q1_rad,x_mm,y_mm,z_mm,rx_rad,ry_rad,rz_rad\n";
  for (const char* point : {"a", "b"})
    for (int q = 0; q < 3; ++q) oriented += vn::message(point, ',', q, ",0,0,0,0,0,0\n");
  EXPECT_NE(refused(oriented).find("have no orientations"), std::string::npos);
}

TEST_F(Reflectors, AreRefusedWhereOneIsNeeded) {
  std::string text = "point,q1_rad,x_mm,y_mm,z_mm\n";
  for (const char* point : {"a", "b"})
    for (int q = 0; q < 3; ++q) text += vn::message(point, ',', q, ",0,0,0\n");
  const std::string said = vernier_test::complaint([&] { (void)vn::read_dataset<1>(file(text)); });
  EXPECT_NE(said.find("several reflectors ('a', 'b', ..)"), std::string::npos) << said;
}

TEST_F(Reflectors, OfArraysAreThoseOfAFile) {
  const auto of_file =
      read("point,q1_rad,x_mm,y_mm,z_mm\n1,1,7,0,0\n2,1,8,0,0\n1,2,7,1,0\n2,2,8,1,0\n1,4,7,2,0\n2,4,8,2,0\n");
  vn::JointRows<1> joints(6, 1);
  joints << 1, 1, 2, 2, 4, 4;
  vn::PointRows positions = vn::PointRows::Zero(6, 3);
  positions.col(0) << 7e-3, 8e-3, 7e-3, 8e-3, 7e-3, 8e-3;
  positions.col(1) << 0, 0, 1e-3, 1e-3, 2e-3, 2e-3;
  const vn::Dataset<1> all(joints, positions);
  const std::vector<std::string> points{"1", "2", "1", "2", "1", "2"};
  const auto of_arrays = vn::split_reflectors(all, points);
  ASSERT_EQ(of_arrays.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(of_arrays[k].point, of_file[k].point);
    EXPECT_TRUE(of_arrays[k].poses.positions().isApprox(of_file[k].poses.positions(), 1e-15));
    EXPECT_TRUE(of_arrays[k].poses.times() == of_file[k].poses.times());
    EXPECT_TRUE(of_arrays[k].poses.previous().bottomRows(2) == of_file[k].poses.previous().bottomRows(2));
  }
  // again nothing changes: the second reflector was approached as the first was
  EXPECT_DOUBLE_EQ(vn::approached_together(vn::approached_together(all, points), points).previous()(3, 0), 1);
  EXPECT_EQ(vn::split_reflectors(all, {}).size(), 1u);
  const auto complaint = [&](const vn::Dataset<1>& data, const std::vector<std::string>& names) {
    return vernier_test::complaint([&] { (void)vn::split_reflectors(data, names); });
  };
  EXPECT_EQ(complaint(all, {"a"}), "reflectors: 1 names of 6 rows");
  EXPECT_EQ(complaint(all, {"a", "b", "a", "b", "a", ""}), "reflectors: row 5 has no name of a reflector");
  EXPECT_EQ(complaint(all, {"a", "a", "a", "a", "a", "b"}),
            "reflectors: 'b' is measured at 1 pose, it needs three or more");
  EXPECT_EQ(complaint(vn::Dataset<1>(joints, positions, vn::PointRows::Zero(6, 3)), points),
            "reflectors: several have no orientations");
}

TEST_F(Reflectors, AreWrittenAndReadBack) {
  const auto before = read(
      "point,q1_rad,x_mm,y_mm,z_mm\nleft,1,10,0,0\nright,2,20,0,0\nleft,3,30,0,0\nright,4,40,0,0\nleft,5,50,0,0\n"
      "right,6,60,0,0\n");
  vn::write_reflectors<1>(folder_ / "out.csv", before);
  const auto after = vn::read_reflectors<1>(folder_ / "out.csv");
  ASSERT_EQ(after.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(after[k].point, before[k].point);
    EXPECT_TRUE(after[k].poses.joints() == before[k].poses.joints());
    EXPECT_TRUE(after[k].poses.positions().isApprox(before[k].poses.positions(), 1e-15));
    EXPECT_TRUE(after[k].poses.times() == before[k].poses.times());
    EXPECT_TRUE(after[k].poses.previous().bottomRows(2) == before[k].poses.previous().bottomRows(2));
  }
  EXPECT_FALSE(vernier_test::complaint([&] {
                 vn::write_reflectors<1>(folder_ / "no.csv", {{"a,b", before[0].poses}});
               }).empty());
  // and what else is known of the rows
  std::vector<vn::ReflectorPoses<1>> known = before;
  const std::vector<vn::Matrix6> covariances(3, 1e-8 * vn::Matrix6::Identity());
  known[0].poses = before[0].poses.at_temperatures(vn::VectorX::Constant(3, 20)).with_covariances(covariances);
  EXPECT_EQ(vernier_test::complaint([&] { vn::write_reflectors<1>(folder_ / "no.csv", known); }),
            "write_reflectors: the temperatures of 1 reflectors of 2 are known");
  known[1].poses = before[1].poses.at_temperatures(vn::VectorX::Constant(3, 25)).with_covariances(covariances);
  vn::write_reflectors<1>(folder_ / "known.csv", known);
  const auto again = vn::read_reflectors<1>(folder_ / "known.csv");
  EXPECT_DOUBLE_EQ(again[1].poses.temperatures()(2), 25);
  ASSERT_EQ(again[0].poses.covariances().size(), 3u);
  EXPECT_NEAR(again[0].poses.covariances()[1](2, 2), 1e-8, 1e-20);
}

}  // namespace
}  // namespace reflectors_test
