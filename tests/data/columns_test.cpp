// SPDX-License-Identifier: BSD-3-Clause
// Columns of CSV files one by one: signs, defaults, and what is written and read again.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/data_error.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"

namespace vernier::columns_test {
namespace {

using vernier_test::complaint;

class Columns : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const {
    const std::string path = folder_ / "c.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  template <class Read>
  std::string refused(const Read& read) const {
    const std::string text = complaint(read);
    return text.substr(std::min(text.find("c.csv"), text.size()));
  }

  vernier_test::TemporaryFolder folder_{"columns"};
};

// Segments may be numbered in any way: what counts is that the number changes.
TEST_F(Columns, SegmentsCountDownToo) {
  const auto data =
      read_dataset<1>(file("segment,q1_rad,x_mm,y_mm,z_mm\n3,1,0,0,0\n3,2,0,0,0\n1,4,0,0,0\n1,5,0,0,0\n2,6,0,0,0\n"));
  EXPECT_TRUE(std::isnan(data.previous()(0, 0)));
  EXPECT_EQ(data.previous()(1, 0), 1);
  EXPECT_TRUE(std::isnan(data.previous()(2, 0)));
  EXPECT_EQ(data.previous()(3, 0), 4);
  EXPECT_TRUE(std::isnan(data.previous()(4, 0)));
  for (Index i = 0; i < 5; ++i)
    EXPECT_EQ(data.times()(i), static_cast<double>(i));  // without a column the row's number
}

// Four cases: the approach of the first row is known; one in the middle is unknown; a later one differs; all follow
// from the order of the rows.
TEST_F(Columns, WrittenWhereTheOrderDoesNotSayIt) {
  JointRows<2> joints(4, 2);
  joints << 1, 2, 3, 4, 5, 6, 7, 8;
  const Dataset<2> ordered(joints, PointRows::Zero(4, 3));
  const double nan = std::nan("");
  for (int which = 0; which < 4; ++which) {
    JointRows<2> previous = ordered.previous();
    if (which == 0) previous.row(0) << 8, 9;
    if (which == 1) previous.row(2) << nan, nan;
    if (which == 2) previous(1, 0) = 0.5;
    VectorX times = ordered.times();
    if (which == 3) times(1) = 1.5;
    const std::string path = file("");
    write_dataset(path, ordered.approached_from(previous).measured_at(times));
    const auto again = read_dataset<2>(path);
    for (Index i = 0; i < 4; ++i) {
      EXPECT_EQ(again.times()(i), times(i));
      for (Index j = 0; j < 2; ++j) {
        // what is unknown is written as an arm that did not move, unless it is the first row of rows in order
        const double expected = !std::isnan(previous(i, j)) ? previous(i, j) : which == 3 ? nan : joints(i, j);
        if (std::isnan(expected))
          EXPECT_TRUE(std::isnan(again.previous()(i, j)));
        else
          EXPECT_EQ(again.previous()(i, j), expected) << which << ' ' << i;
      }
    }
    std::ifstream written(path);
    std::string header;
    std::getline(written, header);
    EXPECT_EQ(header.find("from_q1_rad,from_q2_rad,") == 0, which < 3) << header;
    EXPECT_EQ(header.find("time_s") != std::string::npos, which == 3) << header;
  }
}

TEST_F(Columns, SlidingJointsOfTargetsAndApproaches) {
  const std::array types{JointType::prismatic, JointType::revolute};
  const auto targets = read_targets<2>(file("q1_mm,q2_rad,x_mm,y_mm,z_mm\n500,0.5,1,2,3\n"), types);
  ASSERT_EQ(targets.joints.rows(), 1);
  EXPECT_EQ(targets.joints(0, 0), 0.5);
  EXPECT_DOUBLE_EQ(targets.positions(0, 2), 3e-3);
  const auto poses =
      read_dataset<2>(file("from_q1_mm,from_q2_rad,q1_mm,q2_rad,x_mm,y_mm,z_mm\n250,0.25,500,0.5,1,2,3\n"), types);
  EXPECT_EQ(poses.previous()(0, 0), 0.25);
  EXPECT_EQ(poses.previous()(0, 1), 0.25);
  const auto moves = read_targets<1>(file("q1_rad,move\n1,j\n2,l\n")).linear;
  EXPECT_EQ(moves, (std::vector<bool>{false, true}));
}

TEST_F(Columns, LabelsAreWholeNumbers) {
  const auto read = [&](const std::string& label) {
    return read_labelled_poses(file("visit,x_mm,y_mm,z_mm\n" + label + ",1,2,3\n"), {"visit"});
  };
  EXPECT_EQ(read("-2").labels(0, 0), -2);
  for (const char* wrong : {"-1.5", "1.5"})
    EXPECT_EQ(refused([&] { (void)read(wrong); }),
              message("c.csv, line 2, column visit: ", wrong, ", must be a whole number"));
  const std::string two = file("a,x_mm,y_mm,z_mm\n1,1,2,3\n");
  EXPECT_EQ(refused([&] {
              (void)read_labelled_poses(two, {"a", "b"});
            }),
            "c.csv, line 1: no column b in the header (a, x_mm, y_mm, z_mm)");
  EXPECT_EQ(read_labelled_poses(two, {"a"}, {"b"}).labels(0, 1), 0);
}

TEST_F(Columns, DistancesArePositive) {
  EXPECT_EQ(refused([&] { (void)read_distances<1>(file("q1_rad,distance_mm\n1,0\n")); }),
            "c.csv, line 2, column distance_mm: a distance must be positive");
  EXPECT_DOUBLE_EQ(read_distances<1>(file("q1_rad,distance_um\n1,5\n")).length(0), 5e-6);
}

// Faces may lie below the first one, and a ball has no offset in either direction.
TEST_F(Columns, OffsetsHaveSigns) {
  const std::string header = "contact_id,kind,radius_mm,offset_mm,q1_rad\n";
  const auto steps = read_contacts(file(header + "p,plane,,-5,1\np,plane,,0,2\np,plane,,5,3\np,plane,,,4\n"), 1);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_DOUBLE_EQ(steps[0].known()(0), -5e-3);
  EXPECT_DOUBLE_EQ(steps[0].known()(2), 5e-3);
  EXPECT_EQ(steps[0].known()(3), 0);
  for (const char* offset : {"5", "-5"})
    EXPECT_EQ(refused([&] { (void)read_contacts(file(header + "b,ball,10," + offset + ",1\n"), 1); }),
              "c.csv, line 2, column offset_mm: a ball has a radius, but no offset");
  for (const char* radius : {"5", "-5", "0"})
    EXPECT_EQ(refused([&] { (void)read_contacts(file(header + "s,socket," + radius + ",,1\n"), 1); }),
              "c.csv, line 2, column radius_mm: a socket has no radius");
  EXPECT_EQ(refused([&] { (void)read_contacts(file(header + "b,ball,0,,1\n"), 1); }),
            "c.csv, line 2, column radius_mm: a radius must be positive");
}

// A ball's radius is a length even though all its touches have the same; of faces and sockets differences are.
TEST(Lengths, OfEachKindOfContact) {
  const MatrixX joints = MatrixX::Zero(4, 1);
  EXPECT_TRUE(Contact("b", ContactKind::ball, joints, VectorX::Constant(4, 0.01)).has_length());
  for (const ContactKind kind : {ContactKind::plane, ContactKind::socket}) {
    EXPECT_FALSE(Contact("c", kind, joints, VectorX::Constant(4, 0.01)).has_length());
    EXPECT_TRUE(Contact("c", kind, joints, VectorX::LinSpaced(4, 0, 0.01)).has_length());
  }
}

TEST(Lengths, FewestTouches) {
  const auto told = [](ContactKind kind, Index touches, const VectorX& known) {
    return complaint([&] { (void)Contact("c", kind, MatrixX::Zero(touches, 1), known); });
  };
  for (const auto& [kind, fewest] :
       {std::pair{ContactKind::plane, 4}, {ContactKind::ball, 4}, {ContactKind::socket, 2}}) {
    EXPECT_EQ(told(kind, fewest, VectorX::Constant(fewest, 0.01)), "");
    EXPECT_NE(told(kind, fewest - 1, VectorX::Constant(fewest - 1, 0.01)).find(message("at least ", fewest, " are")),
              std::string::npos);
  }
  EXPECT_NE(told(ContactKind::ball, 4, VectorX::Zero(4)).find("touch 0 has a radius of 0 m, must be positive"),
            std::string::npos);
  EXPECT_EQ(told(ContactKind::plane, 4, VectorX::Zero(4)), "");
}

TEST_F(Columns, ALongHeaderIsCutOff) {
  EXPECT_EQ(refused([&] { (void)read_joints<1>(file("a,b,c,d,e,f,g,h,i,j,k,l\n1,1,1,1,1,1,1,1,1,1,1,1\n")); }),
            "c.csv, line 1: no column q1_rad or q1_deg in the header (a, b, c, d, e, f, g, h, i, j, k, l)");
  EXPECT_EQ(refused([&] { (void)read_joints<1>(file("a,b,c,d,e,f,g,h,i,j,k,l,m\n1,1,1,1,1,1,1,1,1,1,1,1,1\n")); }),
            "c.csv, line 1: no column q1_rad or q1_deg in the header (a, b, c, d, e, f, g, h, i, j, k, l, ...)");
}

// Blocks differ by one row at most.
TEST(Blocks, AreAsEqualAsTheyCanBe) {
  const auto sizes = [](Index n, Index blocks) {
    std::vector<std::size_t> out;
    for (Index block = 0; block < blocks; ++block) out.push_back(detail::rows_of_block(n, block, blocks).test.size());
    std::sort(out.begin(), out.end());
    return out;
  };
  EXPECT_EQ(sizes(10, 4), (std::vector<std::size_t>{2, 2, 3, 3}));
  EXPECT_EQ(sizes(7, 5), (std::vector<std::size_t>{1, 1, 1, 2, 2}));
  EXPECT_EQ(sizes(5, 5), (std::vector<std::size_t>{1, 1, 1, 1, 1}));
}

}  // namespace
}  // namespace vernier::columns_test
