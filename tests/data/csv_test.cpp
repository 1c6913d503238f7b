// SPDX-License-Identifier: BSD-3-Clause
// Reading and writing CSV: every layout that is accepted, and what is said of those that are not.

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vernier/core/rng.hpp>
#include <vernier/data/csv.hpp>

namespace csv_test {
namespace {

using vernier::DataError;
using vernier::Dataset;
using vernier::Index;
using vernier::JointRows;
using vernier::PointRows;
using vernier::read_dataset;
using vernier::read_distances;
using vernier::read_joints;
using vernier::Rng;
using vernier::write_dataset;

constexpr double degree = std::numbers::pi / 180;

/// A folder of its own for each test, gone afterwards.
class Csv : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("vernier_csv_" + std::to_string(getpid()) + "_" +
                                                        testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path in_folder(const std::string& name) const { return folder_ / name; }
  std::filesystem::path file(std::string_view content) const {
    const auto path = in_folder("poses.csv");
    std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    return path;
  }

  /// What reading says of a file; empty when it is read.
  template <int N = 2>
  std::string complaint(std::string_view content) const {
    try {
      (void)read_dataset<N>(file(content));
    } catch (const DataError& e) {
      return e.what();
    }
    return {};
  }

 private:
  std::filesystem::path folder_;
};

void expect_first_row(const Dataset<2>& data) {
  ASSERT_GE(data.size(), 1);
  EXPECT_DOUBLE_EQ(data.joints()(0, 0), 0.5);
  EXPECT_DOUBLE_EQ(data.joints()(0, 1), -1.25);
  EXPECT_DOUBLE_EQ(data.positions()(0, 0), 0.1);
  EXPECT_DOUBLE_EQ(data.positions()(0, 1), -0.2);
  EXPECT_DOUBLE_EQ(data.positions()(0, 2), 0.3);
}

TEST_F(Csv, EveryRowIsApproachedFromTheOneBefore) {
  const auto data = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm\n1,0,0,0\n2,0,0,0\n4,0,0,0\n"));
  EXPECT_TRUE(std::isnan(data.previous()(0, 0)));
  EXPECT_EQ(data.previous()(1, 0), 1);
  EXPECT_EQ(data.previous()(2, 0), 2);
  EXPECT_EQ(data.times()(2), 2);
}

TEST_F(Csv, ASegmentStartsAnew) {
  const auto data = read_dataset<1>(
      file("segment,q1_rad,x_mm,y_mm,z_mm,time_s\n1,1,0,0,0,10\n1,2,0,0,0,20\n7,4,0,0,0,300\n7,8,0,0,0,310.5\n"));
  EXPECT_TRUE(std::isnan(data.previous()(0, 0)));
  EXPECT_EQ(data.previous()(1, 0), 1);
  EXPECT_TRUE(std::isnan(data.previous()(2, 0)));
  EXPECT_EQ(data.previous()(3, 0), 4);
  EXPECT_EQ(data.times()(3), 310.5);
}

TEST_F(Csv, ColumnsMaySayFromWhere) {
  const auto data =
      read_dataset<2>(file("q1_rad,q2_mm,x_mm,y_mm,z_mm,from_q1_deg,from_q2_mm\n1,2,0,0,0,180,-5\n1,2,0,0,0,-90,1\n"));
  EXPECT_DOUBLE_EQ(data.previous()(0, 0), std::numbers::pi);
  EXPECT_DOUBLE_EQ(data.previous()(0, 1), -0.005);
  EXPECT_DOUBLE_EQ(data.previous()(1, 0), -std::numbers::pi / 2);
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,from_q1_rad\n1,2,0,0,0,1\n").find("no column from_q2_rad"),
            std::string::npos);
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,segment\n1,2,0,0,0,first\n").find("line 2, column segment"),
            std::string::npos);
}

// What the order of the rows does not say is written: rows that were taken out keep their approach and their time.
TEST_F(Csv, WrittenRowsKeepTheirApproachAndTime) {
  const auto data = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm\n1,0,0,0\n2,0,0,0\n4,0,0,0\n8,0,0,0\n"));
  const auto again = [&](const Dataset<1>& rows) {
    write_dataset(in_folder("again.csv"), rows);
    return read_dataset<1>(in_folder("again.csv"));
  };
  const auto whole = again(data), some = again(data.rows(std::array<Index, 2>{1, 3}));
  EXPECT_TRUE(std::isnan(whole.previous()(0, 0)));
  EXPECT_EQ(whole.previous().bottomRows(3), data.previous().bottomRows(3));
  EXPECT_EQ(some.previous()(0, 0), 1);
  EXPECT_EQ(some.previous()(1, 0), 4);
  EXPECT_EQ(some.times(), Eigen::Vector2d(1, 3));
  const auto from_start = again(data.rows(std::array<Index, 2>{0, 3}));
  EXPECT_EQ(from_start.previous()(0, 0), from_start.joints()(0, 0));  // unknown: as if it had not moved
}

TEST_F(Csv, TemperaturesAreReadAndWritten) {
  const auto data = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm,temperature_c\n1,0,0,0,21.5\n2,0,0,0,22.25\n"));
  EXPECT_EQ(data.temperatures(), Eigen::Vector2d(21.5, 22.25));
  write_dataset(in_folder("again.csv"), data);
  EXPECT_EQ(read_dataset<1>(in_folder("again.csv")).temperatures(), data.temperatures());
  const auto one = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm,temperature_c\n1,0,0,0,21.5\n"));
  write_dataset(in_folder("one.csv"), one);
  EXPECT_EQ(read_dataset<1>(in_folder("one.csv")).temperatures(), one.temperatures());
  EXPECT_EQ(one.temperatures(), Eigen::VectorXd::Constant(1, 21.5));
  EXPECT_EQ(read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm\n1,0,0,0\n")).temperatures().size(), 0);
  EXPECT_NE(
      complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,temperature_c\n1,2,0,0,0,warm\n").find("line 2, column temperature_c"),
      std::string::npos);
}

TEST_F(Csv, PayloadsAreReadAndWritten) {
  const auto data = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm,payload_kg\n1,0,0,0,2.5\n2,0,0,0,0\n"));
  ASSERT_EQ(data.payloads().rows(), 2);
  EXPECT_EQ(data.payloads().col(0), Eigen::Vector2d(2.5, 0));
  EXPECT_TRUE(std::isnan(data.payloads()(0, 1)) && std::isnan(data.payloads()(1, 3)));
  write_dataset(in_folder("again.csv"), data.rows(std::array<Index, 1>{1}));
  EXPECT_EQ(read_dataset<1>(in_folder("again.csv")).payloads()(0, 0), 0);

  const auto centred = read_dataset<1>(
      file("q1_rad,x_mm,y_mm,z_mm,payload_z_m,payload_kg,payload_x_mm,payload_y_mm\n1,0,0,0,0.25,5,10,-20\n"));
  EXPECT_EQ(centred.payloads(), (Eigen::MatrixXd{{5, 0.01, -0.02, 0.25}}));
  write_dataset(in_folder("again.csv"), centred);
  EXPECT_EQ(read_dataset<1>(in_folder("again.csv")).payloads(), centred.payloads());
  EXPECT_EQ(read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm\n1,0,0,0\n")).payloads().rows(), 0);
  EXPECT_NE(complaint("q1_rad,q2_rad,x_mm,y_mm,z_mm,payload_kg\n1,2,0,0,0,-1\n").find("line 2, column payload_kg"),
            std::string::npos);
}

TEST_F(Csv, ReadsPositions) {
  const auto data = read_dataset<2>(file("q1_rad,q2_rad,x_mm,y_mm,z_mm\n0.5,-1.25,100,-200,300\n1,2,3,4,5\n"));
  expect_first_row(data);
  EXPECT_EQ(data.size(), 2);
  EXPECT_FALSE(data.has_orientations());
  EXPECT_DOUBLE_EQ(data.positions()(1, 2), 0.005);
}

TEST_F(Csv, ReadsOrientationsAsRotationVectors) {
  const auto data = read_dataset<1>(file("q1_rad,x_mm,y_mm,z_mm,rx_rad,ry_deg,rz_mrad\n0,1,2,3,0.25,90,-500\n"));
  ASSERT_TRUE(data.has_orientations());
  EXPECT_DOUBLE_EQ(data.orientations()(0, 0), 0.25);
  EXPECT_DOUBLE_EQ(data.orientations()(0, 1), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(data.orientations()(0, 2), -0.5);
}

TEST_F(Csv, AnyColumnOrderAndUnknownColumns) {
  expect_first_row(read_dataset<2>(
      file("temperature_c,z_mm,q2_rad,comment,y_mm,x_mm,q1_rad,q1_volt\n21.5,300,-1.25,a word,-200,100,0.5,nan\n")));
}

TEST_F(Csv, UnitsComeFromTheNames) {
  const auto data = read_dataset<2>(file("q1_deg,q2_mrad,x_m,y_um,z_mm\n90,1500,0.25,-125,12.5\n"));
  EXPECT_DOUBLE_EQ(data.joints()(0, 0), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(data.joints()(0, 1), 1.5);
  EXPECT_DOUBLE_EQ(data.positions()(0, 0), 0.25);
  EXPECT_DOUBLE_EQ(data.positions()(0, 1), -125e-6);
  EXPECT_DOUBLE_EQ(data.positions()(0, 2), 0.0125);
}

TEST_F(Csv, PrismaticJointsAreLengths) {
  const auto data = read_dataset<3>(file("q1_mm,q2_deg,q3_m,x_mm,y_mm,z_mm\n250,180,0.125,0,0,0\n"));
  EXPECT_DOUBLE_EQ(data.joints()(0, 0), 0.25);
  EXPECT_DOUBLE_EQ(data.joints()(0, 1), std::numbers::pi);
  EXPECT_DOUBLE_EQ(data.joints()(0, 2), 0.125);
}

TEST_F(Csv, UnitsFitTheTypesOfJoints) {
  using vernier::JointType;
  const std::array types{JointType::prismatic, JointType::revolute};
  const auto said = [&](std::string_view header) -> std::string {
    const std::string path = file(std::string(header) + ",x_mm,y_mm,z_mm\n250,180,1,2,3\n");
    try {
      EXPECT_DOUBLE_EQ(read_dataset<2>(path, types).joints()(0, 0), 0.25);
    } catch (const DataError& e) {
      return std::string(e.what()).substr(path.size());
    }
    return {};
  };
  EXPECT_EQ(said("q1_mm,q2_deg"), "");
  EXPECT_EQ(said("q1_deg,q2_rad"), ", line 1: column q1_deg, but joint 1 is prismatic: a length is needed");
  EXPECT_EQ(said("q1_mm,q2_mm"), ", line 1: column q2_mm, but joint 2 is revolute: an angle is needed");
}

TEST_F(Csv, LineEndsMarksBlanksAndSpaces) {
  const std::string header = "q1_rad,q2_rad,x_mm,y_mm,z_mm", row = "0.5,-1.25,100,-200,300";
  for (const std::string& content : {
           header + "\r\n" + row + "\r\n",                 // CRLF
           "\xEF\xBB\xBF" + header + "\n" + row + "\n",    // byte-order mark
           "\xEF\xBB\xBF" + header + "\r\n" + row,         // both, and no line end at the end
           "\n\n" + header + "\n\n" + row + "\n\n  \t\n",  // blank lines
           header + "\r\n\r\n" + row + "\r\n\r\n",         // blank CRLF lines
           std::string(" q1_rad ,\tq2_rad, x_mm,y_mm , z_mm\n 0.5 ,\t-1.25, 100 ,-200,\t300 \n"),
           header + "\n+0.5,-1.25e0,1e2,-2.0E+2,3.e2\n",  // ways to write a number
       }) {
    SCOPED_TRACE(testing::PrintToString(content));
    const auto data = read_dataset<2>(file(content));
    EXPECT_EQ(data.size(), 1);
    expect_first_row(data);
  }
}

TEST_F(Csv, TargetsNeedJointsAlone) {
  const JointRows<2> q = read_joints<2>(file("note,q2_deg,q1_rad\nhome,45,0.5\nx,-45,1\n"));
  ASSERT_EQ(q.rows(), 2);
  EXPECT_DOUBLE_EQ(q(0, 0), 0.5);
  EXPECT_DOUBLE_EQ(q(1, 1), -45 * degree);
}

TEST_F(Csv, ReadsTargetsOfAPath) {
  const auto joints = vernier::read_targets<2>(file("q2_deg,q1_rad\n45,0.5\n-45,1\n"));
  ASSERT_EQ(joints.size(), 2);
  EXPECT_DOUBLE_EQ(joints.joints(0, 0), 0.5);
  EXPECT_DOUBLE_EQ(joints.joints(1, 1), -45 * degree);
  EXPECT_EQ(joints.positions.rows(), 0);
  EXPECT_TRUE(joints.linear.empty());

  const auto poses =
      vernier::read_targets<2>(file("move,x_mm,y_mm,z_m,rx_rad,ry_rad,rz_deg\nj,1,2,3,0.1,0.2,45\n l ,4,5,6,0,0,0\n"));
  ASSERT_EQ(poses.size(), 2);
  EXPECT_EQ(poses.joints.rows(), 0);
  EXPECT_EQ(poses.linear, (std::vector<bool>{false, true}));
  EXPECT_LT((poses.positions.row(0) - Eigen::RowVector3d(0.001, 0.002, 3)).norm(), 1e-15);
  EXPECT_LT((poses.orientations.row(0) - Eigen::RowVector3d(0.1, 0.2, 45 * degree)).norm(), 1e-15);

  const auto both = vernier::read_targets<2>(file("q1_rad,q2_rad,x_mm,y_mm,z_mm\n0.1,0.2,1,2,3\n"));
  EXPECT_EQ(both.joints.rows(), 1);
  EXPECT_EQ(both.positions.rows(), 1);
  EXPECT_EQ(both.orientations.rows(), 0);
}

TEST_F(Csv, MalformedTargetsAreNamed) {
  const std::vector<std::pair<std::string, std::vector<const char*>>> files{
      {"q1_rad\n1\n", {"no column q2_rad"}},
      {"x_mm,y_mm\n1,2\n", {"no column z_mm"}},
      {"x_mm,y_mm,z_mm,rx_rad\n1,2,3,4\n", {"no column ry_rad"}},
      {"q1_rad,q2_rad,move\n1,2,j\n1,2,c\n", {"line 3", "move", "'c'", "j (joint move) or l (linear move)"}},
      {"q1_rad,q2_rad,move\n1,2,\n", {"line 2", "move"}},
      {"move,note\nj,a\n", {"no column q1_rad"}},
  };
  for (const auto& [content, words] : files) {
    SCOPED_TRACE(content);
    try {
      (void)vernier::read_targets<2>(file(content));
      ADD_FAILURE() << "no complaint";
    } catch (const DataError& e) {
      for (const char* word : words) EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }
}

TEST_F(Csv, ReadsDistances) {
  const auto data = read_distances<2>(file("distance_mm,q2_deg,q1_rad\n1500,90,0.5\n\n2.5,0,1\n"));
  ASSERT_EQ(data.size(), 2);
  EXPECT_DOUBLE_EQ(data.length(0), 1.5);
  EXPECT_DOUBLE_EQ(data.length(1), 0.0025);
  EXPECT_DOUBLE_EQ(data.joints()(0, 0), 0.5);
  EXPECT_DOUBLE_EQ(data.joints()(0, 1), std::numbers::pi / 2);
  const auto says = [&](std::string_view content) -> std::string {
    try {
      (void)read_distances<2>(file(content));
    } catch (const DataError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_NE(says("q1_rad,q2_rad,distance_mm\n1,2,3\n\n1,2,0\n").find("line 4, column distance_mm: a distance must"),
            std::string::npos);
  EXPECT_NE(says("q1_rad,q2_rad,x_mm\n1,2,3\n").find("no column distance_mm"), std::string::npos);
  EXPECT_NE(says("q1_rad,q2_rad,distance_mm\n").find("no rows"), std::string::npos);
}

TEST_F(Csv, WritesWhatItReads) {
  Rng rng(3);
  for (const bool oriented : {false, true}) {
    JointRows<6> q(50, 6);
    PointRows p(50, 3), r(oriented ? 50 : 0, 3);
    for (auto& value : q.reshaped()) value = rng.uniform(-3, 3);
    for (auto& value : p.reshaped()) value = rng.uniform(-2, 2);
    for (auto& value : r.reshaped()) value = rng.uniform(-1, 1);
    q(0, 0) = 1e-17;
    q(1, 0) = -0.1;
    const Dataset<6> data(q, p, r);
    write_dataset<6>(in_folder("out.csv"), data);
    const auto back = read_dataset<6>(in_folder("out.csv"));
    EXPECT_TRUE(back.joints() == q);
    EXPECT_TRUE(back.orientations() == r);
    ASSERT_EQ(back.positions().rows(), 50);
    // metres to millimetres and back: two roundings
    EXPECT_LE(((back.positions() - p).array().abs() / p.array().abs()).maxCoeff(), 4.5e-16);
    EXPECT_FALSE(std::filesystem::exists(in_folder("out.csv.partial")));
  }
}

TEST_F(Csv, AFileThatCannotBeWrittenLeavesNothing) {
  const Dataset<1> data(JointRows<1>::Zero(1, 1), PointRows::Zero(1, 3));
  const auto path = in_folder("no_such_folder/out.csv");
  try {
    write_dataset<1>(path, data);
    FAIL() << "no complaint";
  } catch (const std::runtime_error& e) {
    EXPECT_NE(std::string(e.what()).find("out.csv"), std::string::npos) << e.what();
  }
  EXPECT_FALSE(std::filesystem::exists(path.parent_path()));
  std::filesystem::create_directories(in_folder("taken.csv"));
  EXPECT_THROW(write_dataset<1>(in_folder("taken.csv"), data), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(in_folder("taken.csv.partial")));
}

TEST_F(Csv, AMissingFileAndAFolderAreNamed) {
  for (const auto& [path, word] :
       {std::pair{in_folder("absent.csv"), "absent.csv: No such file"}, std::pair{in_folder("."), "is a folder"}}) {
    try {
      (void)read_dataset<2>(path);
      FAIL() << "no complaint";
    } catch (const DataError& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }
}

// What is no table does not fill the memory.
TEST_F(Csv, LimitsOfSize) {
  const auto said = [](const std::string& path) -> std::string {
    try {
      (void)read_joints<2>(path);
    } catch (const DataError& e) {
      return e.what();
    }
    return "nothing";
  };
  std::string commas = "q1_rad,q2_rad", values = "1,2";
  for (int k = 2; k < 1000; ++k) {
    commas += ",";
    values += ",x";
  }
  EXPECT_EQ(said(file(commas + "\n" + values + "\n")), "nothing");
  const std::string wide = file(commas + ",\n");
  EXPECT_EQ(said(wide), wide + ", line 1: has more than 1000 values");
  const std::string wide_row = file(commas + "\n" + values + "\n" + values + ",3\n");
  EXPECT_EQ(said(wide_row), wide_row + ", line 3: has more than 1000 values");
  std::string rows = "q1_rad,q2_rad\n";
  for (int k = 0; k <= 1'000'000; ++k) rows += "1\n";
  const std::string long_file = file(rows);
  EXPECT_EQ(said(long_file), long_file + ": has more than 1000000 rows");
  EXPECT_EQ(said("/dev/zero"), "/dev/zero: has more than 256 MiB");
}

struct Malformed {
  const char* what;
  std::string content;
  std::vector<const char*> said;  ///< each is part of the message
};

const std::string head = "q1_rad,q2_rad,x_mm,y_mm,z_mm\n";

/// Files for a robot of two joints.
std::vector<Malformed> malformed_files() {
  using namespace std::string_literals;
  const std::string good = "0.1,0.2,1,2,3\n";
  return {
      // headers
      {"empty file", "", {"poses.csv", "empty", "header"}},
      {"blank lines alone", "\n \r\n\n", {"poses.csv", "empty"}},
      {"a byte-order mark alone", "\xEF\xBB\xBF", {"poses.csv", "empty"}},
      {"header only", head, {"poses.csv", "no rows"}},
      {"header without line end", "q1_rad,q2_rad,x_mm,y_mm,z_mm", {"no rows"}},
      {"no header", good + good, {"poses.csv", "no column q1_rad or q1_deg", "0.1, 0.2, 1"}},
      {"a joint is missing", "q1_rad,x_mm,y_mm,z_mm\n1,2,3,4\n", {"no column q2_rad", "q1_rad, x_mm"}},
      {"x is missing", "q1_rad,q2_rad,y_mm,z_mm\n1,2,3,4\n", {"no column x_mm or x_m"}},
      {"z is missing", "q1_rad,q2_rad,x_mm,y_mm\n1,2,3,4\n", {"no column z_mm"}},
      {"no units", "q1,q2,x,y,z\n1,2,3,4,5\n", {"no column q1_rad"}},
      {"unknown unit", "q1_rad,q2_rad,x_inch,y_mm,z_mm\n1,2,3,4,5\n", {"no column x_mm", "x_inch"}},
      {"an angle as a position", "q1_rad,q2_rad,x_rad,y_mm,z_mm\n1,2,3,4,5\n", {"no column x_mm"}},
      {"names in capitals",
       "Q1_RAD,Q2_RAD,X_MM,Y_MM,Z_MM\n1,2,3,4,5\n",
       {"line 1: no column q1_rad", "is 'Q1_RAD' q1_rad?"}},
      {"names of a controller",
       "J1,J2,x_mm,y_mm,z_mm\n1,2,3,4,5\n",
       {"; if that is J1, state --columns 'q1_rad=J1' or 'q1_deg=J1' (CsvFormat)"}},
      {"another name",
       "q1_deg,Joint 2,x_mm,y_mm,z_mm\n1,2,3,4,5\n",
       {"; if that is Joint 2, state --columns 'q2_rad=Joint 2' or 'q2_deg=Joint 2' (CsvFormat)"}},
      {"semicolons", "q1_rad;q2_rad;x_mm;y_mm;z_mm\n1;2;3;4;5\n", {"line 1", "separated by ';'", "--separator ';'"}},
      {"tabs", "q1_rad\tq2_rad\tx_mm\ty_mm\tz_mm\n1\t2\t3\t4\t5\n", {"by tabs", "--separator tab"}},
      {"two units of a joint", "q1_rad,q1_deg,q2_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 1", "q1_rad", "q1_deg"}},
      {"two units of a position", "q1_rad,q2_rad,x_mm,x_m,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 1", "x_mm", "x_m "}},
      {"one name twice",
       "q1_rad,q1_rad,q2_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n",
       {"line 1", "column q1_rad is there twice"}},
      {"revolute and prismatic", "q1_rad,q1_mm,q2_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 1", "q1_mm", "q1_rad"}},
      {"twice, header on line 3", "\n\nq1_rad,q1_deg,q2_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 3", "q1_deg"}},
      {"a third joint", "q1_rad,q2_rad,q3_rad,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 1", "q3_rad", "2 joints"}},
      {"a third, prismatic", "q1_rad,q2_rad,q3_mm,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n", {"line 1", "q3_mm", "2 joints"}},
      {"half an orientation", "q1_rad,q2_rad,x_mm,y_mm,z_mm,rx_rad\n1,2,3,4,5,6\n", {"no column ry_rad"}},
      {"orientation without x", "q1_rad,q2_rad,x_mm,y_mm,z_mm,ry_rad,rz_rad\n1,2,3,4,5,6,7\n", {"no column rx_rad"}},
      // rows
      {"a value too few", head + good + "0.1,0.2,1,2\n", {"poses.csv", "line 3", "4 values", "has 5"}},
      {"a value too many", head + "0.1,0.2,1,2,3,4\n", {"line 2", "6 values", "has 5"}},
      {"a comma at the end", head + "0.1,0.2,1,2,3,\n", {"line 2", "6 values"}},
      {"decimal commas", head + "0,1,0,2,1,0,2,0,3,0\n", {"line 2", "10 values", "--decimal"}},
      {"a truncated last line", head + good + good + "0.1,0.", {"line 4", "2 values"}},
      {"blank lines count", head + "\n\n" + good + "\n0.1,0.2,1,2\n", {"line 6", "4 values"}},
      {"CRLF lines count", "q1_rad,q2_rad,x_mm,y_mm,z_mm\r\n\r\n0.1,x,1,2,3\r\n", {"line 3", "q2_rad", "'x'"}},
      {"the header again", head + good + head, {"line 3", "column q1_rad", "'q1_rad' is not a number"}},
      // values
      {"NaN", head + "nan,0.2,1,2,3\n", {"line 2", "column q1_rad", "'nan' is not finite"}},
      {"NaN in capitals", head + "0.1,NaN,1,2,3\n", {"line 2", "column q2_rad", "not finite"}},
      {"NaN with a payload", head + "0.1,nan(7),1,2,3\n", {"line 2", "column q2_rad", "not finite"}},
      {"inf", head + "0.1,0.2,inf,2,3\n", {"line 2", "column x_mm", "'inf' is not finite"}},
      {"-inf", head + "0.1,0.2,1,-inf,3\n", {"line 2", "column y_mm", "'-inf' is not finite"}},
      {"+infinity", head + "0.1,0.2,1,2,+infinity\n", {"line 2", "column z_mm", "not finite"}},
      {"an empty cell", head + good + "0.1,,1,2,3\n", {"line 3", "column q2_rad", "no value"}},
      {"a cell of spaces", head + "0.1,0.2,1,  ,3\n", {"line 2", "column y_mm", "no value"}},
      {"an empty last cell", head + "0.1,0.2,1,2,\n", {"line 2", "column z_mm", "no value"}},
      {"text", head + "0.1,0.2,1,2,three\n", {"line 2", "column z_mm", "'three' is not a number"}},
      {"a unit behind", head + "0.1,0.2,1mm,2,3\n", {"line 2", "column x_mm", "'1mm' is not a number"}},
      {"a quote in a cell", head + "0.1,0.2,1\",2,3\n", {"line 2", "column x_mm", "not a number"}},
      {"an open quote", head + "0.1,0.2,\"1,2,3\n", {"line 2", "quotation mark without its partner"}},
      {"a quote that ends early", head + "0.1,0.2,\"1\"2,2,3\n", {"line 2", "text behind a closing quotation mark"}},
      {"hexadecimal", head + "0x10,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"two numbers", head + "0.1 0.2,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"two signs", head + "+-1,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"a sign alone", head + "+,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"a point alone", head + ".,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"an exponent alone", head + "e5,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"two points", head + "1.2.3,0.2,1,2,3\n", {"line 2", "column q1_rad", "not a number"}},
      {"beyond a double", head + "1e400,0.2,1,2,3\n", {"line 2", "column q1_rad", "out of range"}},
      {"huge", head + "0.1,0.2,1e300,2,3\n", {"line 2", "column x_mm", "beyond any coordinate on Earth"}},
      {"just too large", head + "0.1,-10000,1,2,3\n", {"line 2", "column q2_rad", "beyond any joint angle"}},
      {"a delete character", head + "0.1,5\x7f,1,2,3\n", {"line 2", "column q2_rad", "'5?' is not a number"}},
      {"four hundred digits", head + std::string(400, '9') + ",0.2,1,2,3\n", {"line 2", "column q1_rad", "..."}},
      {"bad after good", head + good + good + "0.1,0.2,1,2,?\n" + good, {"line 4", "column z_mm", "'?'"}},
      {"a full stop of another script", head + "0\xC2\xB7"s + "1,0.2,1,2,3\n", {"line 2", "column q1_rad", "'0??1'"}},
      // what is no text
      {"a zero byte", head + "0.1,0.2,1,2,3\0\n"s, {"line 2", "binary"}},
      {"a program",
       "\x7F"
       "ELF\2\1\1\0\0\0\0\0\0"s,
       {"line 1", "binary"}},
      {"UTF-16", "\xFF\xFEq\0001\0_\0r\0"s, {"line 1", "binary"}},
      {"control characters", "\x01\x02\x03,\x1b[31m\n1,2\n", {"no column q1_rad", "???, ?[31m"}},
      {"an escape in a cell", head + "\x1b[2J,0.2,1,2,3\n", {"line 2", "'?[2J' is not a number"}},
      {"a picture", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR"s, {"binary"}},
  };
}

TEST_F(Csv, EveryMalformedFileGetsOneClearLine) {
  for (const Malformed& file : malformed_files()) {
    SCOPED_TRACE(file.what);
    const std::string said = complaint(file.content);
    ASSERT_FALSE(said.empty()) << "accepted";
    EXPECT_NE(said.find("poses.csv"), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_LT(said.size(), 600u) << said;
    for (const unsigned char c : said) EXPECT_TRUE(c >= ' ' && c <= '~') << said;
    for (const char* part : file.said) EXPECT_NE(said.find(part), std::string::npos) << part << " is not in: " << said;
  }
}

TEST_F(Csv, TruncatedAnywhereNeverCrashes) {
  const std::string whole = "\xEF\xBB\xBFq1_deg,q2_mm,x_mm,y_m,z_um,rx_rad,ry_rad,rz_rad\r\n1.5e-1,+2,3,4,-5,6,7,8\r\n";
  int accepted = 0;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const std::string said = complaint(whole.substr(0, n));
    if (said.empty()) ++accepted;
  }
  // only the line end may be missing; a number cut short cannot be told from a number
  EXPECT_EQ(accepted, 2);
}

TEST_F(Csv, RandomBytesNeverCrash) {
  Rng rng(11);
  for (int i = 0; i < 300; ++i) {
    std::string content = i % 2 == 0 ? head : "";
    const auto n = rng.below(200);
    for (std::uint64_t k = 0; k < n; ++k) {
      constexpr std::string_view likely = "0123456789.,-+eEnaif\n\r\t q_";
      content += i % 3 == 0 ? static_cast<char>(rng.below(256)) : likely[rng.below(likely.size())];
    }
    try {
      const auto data = read_dataset<2>(file(content));
      EXPECT_TRUE(data.joints().allFinite() && data.positions().allFinite());
    } catch (const DataError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

// The measured poses, where there are any.
TEST(MeasuredFiles, HaveTheRightSizes) {
  const char* folder = std::getenv("VERNIER_DATA_DIR");
  if (folder == nullptr || *folder == '\0') GTEST_SKIP() << "VERNIER_DATA_DIR names no folder of measured poses";
  const std::filesystem::path data(folder);
  const auto ur10 = read_dataset<6>(data / "ur10_random_poses.csv");
  EXPECT_EQ(ur10.size(), 2773);
  EXPECT_TRUE(ur10.has_orientations());
  EXPECT_DOUBLE_EQ(ur10.joints()(0, 0), -3.14159);
  EXPECT_DOUBLE_EQ(ur10.positions()(0, 1), -3.24075620);
  const auto ur5 = read_dataset<6>(data / "ur5_grid.csv");
  EXPECT_EQ(ur5.size(), 1000);
  EXPECT_FALSE(ur5.has_orientations());
  const auto wam = read_dataset<7>(data / "wam_grid.csv");
  EXPECT_EQ(wam.size(), 216);
  EXPECT_FALSE(wam.has_orientations());
  EXPECT_THROW((void)read_dataset<6>(data / "wam_grid.csv"), DataError);  // seven joints
  EXPECT_THROW((void)read_dataset<7>(data / "ur5_grid.csv"), DataError);  // six
}

}  // namespace
}  // namespace csv_test
