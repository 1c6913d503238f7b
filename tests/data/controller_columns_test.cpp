// SPDX-License-Identifier: BSD-3-Clause
// Files with the joint values of a controller that counts differently than the chain.
#include <gtest/gtest.h>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/data/csv.hpp"

namespace vernier::controller_columns_test {
namespace {

const std::vector<std::string> palletiser{"J1", "J2", "J3 - J2", "-J3", "J4"}, fanuc{"J1", "J2", "-J2 - J3"};

class ControllerColumns : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const {
    write_file(path_, text);
    return path_.string();
  }
  vernier_test::TemporaryFolder folder_{"controller_columns"};
  std::filesystem::path path_ = folder_ / "poses.csv";
};

TEST_F(ControllerColumns, ReadersReturnJointsOfTheChain) {
  const CsvFormat format{.controller = ControllerMap(fanuc)};
  const std::string poses = file(
      "from_q1_rad,from_q2_rad,from_q3_rad,q3_rad,q1_rad,q2_rad,x_mm,y_mm,z_mm\n"
      "0.5,0.25,0.125,4,1,2,10,20,30\n");
  const auto data = read_dataset<3>(poses, {}, format);
  EXPECT_EQ(data.joints(0), (JointVector<3>{1, 2, -6}));
  EXPECT_EQ(JointVector<3>(data.previous().row(0).transpose()), (JointVector<3>{0.5, 0.25, -0.375}));
  EXPECT_DOUBLE_EQ(data.positions()(0, 2), 0.03);
  EXPECT_EQ(JointVector<3>(read_joints<3>(poses, {}, format).row(0).transpose()), (JointVector<3>{1, 2, -6}));
  EXPECT_EQ(read_targets<3>(poses, {}, format).joints(0, 2), -6);
  const auto ordered =
      read_dataset<3>(file("q1_rad,q2_rad,q3_rad,x_mm,y_mm,z_mm\n1,2,3,0,0,0\n4,5,6,0,0,0\n"), {}, format);
  EXPECT_EQ(ordered.previous()(1, 2), -5);
  EXPECT_EQ(read_distances<3>(file("q1_rad,q2_rad,q3_rad,distance_mm\n1,2,3,500\n"), {}, format).joints()(0, 2), -5);
  const auto touched = read_contacts(
      file("q1_rad,q2_rad,q3_rad,contact_id,kind\n1,2,3,a,plane\n1,2,4,a,plane\n1,2,5,a,plane\n1,2,6,a,plane\n"), 3, {},
      format);
  EXPECT_EQ(touched.front().joints()(1, 2), -6);
}

TEST_F(ControllerColumns, APassiveJointHasNoColumn) {
  const CsvFormat format{.controller = ControllerMap(palletiser)};
  const auto data = read_dataset<5>(file("q1_rad,q2_rad,q3_rad,q4_rad,x_mm,y_mm,z_mm\n1,2,5,7,10,20,30\n"), {}, format);
  EXPECT_EQ(data.joints(0), (JointVector<5>{1, 2, 3, -5, 7}));
  EXPECT_EQ(vernier_test::complaint(
                [&] { (void)read_joints<5>(file("q1_rad,q2_rad,q3_rad,q4_rad,q5_rad\n1,2,5,7,9\n"), {}, format); }),
            path_.string() + ", line 1: column q5_rad, but the controller has 4 joints");
}

TEST_F(ControllerColumns, WhatIsWrittenIsReadBack) {
  using enum JointType;
  const std::vector<JointType> types{prismatic, revolute, revolute};
  const std::vector<std::string> formulas{"-J1 + 250 mm", "J2", "J2 + J3"};
  const ControllerMap map(formulas, types);
  JointRows<3> joints(3, 3);
  joints << 0.25, 1, 2, 0.5, -1, 0.5, -0.75, 0.25, 3;
  const Dataset<3> data(joints, PointRows::Random(3, 3), PointRows(0, 3));
  write_dataset(path_.string(), data, types, map);
  EXPECT_EQ(read_file(path_).substr(0, 20), "q1_m,q2_rad,q3_rad,x");
  const auto back = read_dataset<3>(path_.string(), types, {.controller = map});
  EXPECT_EQ(back.joints(), joints);
  EXPECT_TRUE(back.previous().bottomRows(2) == joints.topRows(2));
  const auto shown = read_joints<3>(path_.string());
  EXPECT_EQ(JointVector<3>(shown.row(0).transpose()), (JointVector<3>{0, 1, 1}));
}

}  // namespace
}  // namespace vernier::controller_columns_test
