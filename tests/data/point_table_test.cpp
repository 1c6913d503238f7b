// SPDX-License-Identifier: BSD-3-Clause
// Tables of points in declared formats, and one example of each damage with its message.

#include "vernier/data/point_table.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "complaint.hpp"
#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/data/csv.hpp"

namespace vernier::point_table_test {
namespace {

class PointTables : public ::testing::Test {
 protected:
  PointTable read(const std::string& text, const PointTableFormat& format = {}) const {
    std::filesystem::current_path(folder_.path());
    write_file("points.txt", text);
    return read_point_table("points.txt", format);
  }
  std::string refused(const std::string& text, const PointTableFormat& format = {}) const {
    return vernier_test::complaint([&] { (void)read(text, format); });
  }
  ~PointTables() override { std::filesystem::current_path(before_); }

  std::filesystem::path before_ = std::filesystem::current_path();
  vernier_test::TemporaryFolder folder_{"point_table"};
};

TEST_F(PointTables, SpatialAnalyzer) {
  const PointTable table = read(
      "\xEF\xBB\xBF// SpatialAnalyzer\r\n  // frame A::WORLD\r\nA Main p1  100.5 -200 +3e2\r\n\r\nA\tMain p2 1 2 3\r\n",
      PointTableFormat::spatial_analyzer(length_unit("mm")));
  ASSERT_EQ(table.lines, (std::vector<Index>{3, 5}));
  EXPECT_EQ(table.names, (std::vector<std::string>{"p1", "p2"}));
  EXPECT_LT((table.points.row(0) - Eigen::RowVector3d(0.1005, -0.2, 0.3)).norm(), 1e-15);
  EXPECT_LT((table.points.row(1) - Eigen::RowVector3d(0.001, 0.002, 0.003)).norm(), 1e-15);
}

TEST_F(PointTables, DecimalCommaOtherColumnsAndUnits) {
  const PointTable table =
      read("title\nno;z;time;x;y\n1; -1,5;12:30;2,25;0,125\n", {.columns = {"number", "z", "time", "x", "y"},
                                                                .separator = ';',
                                                                .decimal = ',',
                                                                .header_lines = 2,
                                                                .unit = length_unit("in")});
  EXPECT_TRUE(table.names.empty());
  EXPECT_EQ(table.lines, std::vector<Index>{3});
  EXPECT_LT((table.points.row(0) - 0.0254 * Eigen::RowVector3d(2.25, 0.125, -1.5)).norm(), 1e-15);
  EXPECT_EQ(length_unit("um"), 1e-6);
  EXPECT_EQ(length_unit("cm"), 1e-2);
  EXPECT_EQ(length_unit("m"), 1);
  EXPECT_DOUBLE_EQ(length_unit("ft"), 12 * length_unit("in"));
}

TEST_F(PointTables, EachDamageHasItsLine) {
  const std::string good = "p1,1,2,3\n";
  EXPECT_EQ(refused(good + "p2,1,x2,3\n"), "points.txt, line 2, column y: 'x2' is not a number");
  EXPECT_EQ(refused(good + "p2,1,2.5.1,3\n"), "points.txt, line 2, column y: '2.5.1' is not a number");
  EXPECT_EQ(refused(good + "\np2,1,2,nan\n"), "points.txt, line 3, column z: 'nan' is not finite");
  EXPECT_EQ(refused(good + "p2,-inf,2,3\n"), "points.txt, line 2, column x: '-inf' is not finite");
  EXPECT_EQ(refused(good + "p2,1e999,2,3\n"), "points.txt, line 2, column x: '1e999' is out of range");
  EXPECT_EQ(refused(good + "p2,1e12,2,3\n"),
            "points.txt, line 2, column x: '1e12' is beyond any coordinate on Earth (1e7 m)");
  EXPECT_EQ(refused(good + "p2,1,,3\n"), "points.txt, line 2, column y: no value");
  EXPECT_EQ(refused(good + ",1,2,3\n"), "points.txt, line 2, column name: no value");
  EXPECT_EQ(refused(good + "p2,1,2\n"),
            "points.txt, line 2: 3 cells, 4 columns are declared, separated by ',': 'p2,1,2'");
  EXPECT_EQ(refused("p1 1 2 3\n"), "points.txt, line 1: 1 cell, 4 columns are declared, separated by ',': 'p1 1 2 3'");
  EXPECT_EQ(refused("p1,1,5,2,3\n"),
            "points.txt, line 1: 5 cells, 4 columns are declared, separated by ',': 'p1,1,5,2,3'");
  EXPECT_EQ(
      refused("p1;1.5;2;3\n", {.separator = ';', .decimal = ','}),
      "points.txt, line 1, column x: '1.5' is not a number; if its point is a decimal one: --decimal . (format.decimal "
      "in code)");
  EXPECT_EQ(refused("p1;1,5;2;3\n", {.separator = ';'}),
            "points.txt, line 1, column x: '1,5' is not a number; if its comma is a decimal one: --decimal ',' "
            "(format.decimal "
            "in code)");
  EXPECT_EQ(refused(std::string("p\0", 2)), "points.txt, line 1: binary data, not text");
  EXPECT_EQ(refused(std::string(5000, ',') + "\n"),
            "points.txt, line 1: more than 1000 cells, 4 columns are declared, separated by ',': '" +
                std::string(40, ',') + "...'");
  EXPECT_EQ(refused(std::string(4000, 'a') + " b"),
            "points.txt, line 1: 1 cell, 4 columns are declared, separated by "
            "',': '" +
                std::string(40, 'a') + "...'");
  std::string rows;
  for (int k = 0; k < 1'000'002; ++k) rows += "1\n";
  EXPECT_EQ(refused(rows), "points.txt: has more than 1000000 rows");
  EXPECT_EQ(refused("// none\n", {.comment = "//"}), "points.txt: no points");
  EXPECT_EQ(refused(""), "points.txt: no points");
  EXPECT_EQ(vernier_test::complaint([] { (void)read_point_table("missing.txt", {}); }),
            "missing.txt: No such file or directory");
}

TEST_F(PointTables, FormatsThatCannotBe) {
  EXPECT_EQ(refused("1,2,3\n", {.columns = {"x", "y"}}), "PointTableFormat: no column z");
  EXPECT_EQ(refused("1,2,3\n", {.columns = {"x", "y", "z", "x"}}), "PointTableFormat: column x is there twice");
  EXPECT_EQ(refused("1,2,3\n", {.columns = {"x", "y", "z"}, .decimal = ','}),
            "PointTableFormat: ',' is both the separator and the decimal point");
  EXPECT_EQ(refused("1,2,3\n", {.unit = 0}), "PointTableFormat: unit is 0, must be positive");
  EXPECT_EQ(vernier_test::complaint([] { (void)length_unit("parsec"); }),
            "no unit of lengths is called 'parsec'; there are um, mm, cm, m, in, ft");
}

TEST_F(PointTables, TextOfCsvFiles) {
  std::filesystem::current_path(folder_.path());
  write_file("joints.csv", "target, q1_rad\r\n\r\nP 1,0.10\r\nP2,\r\n");
  const CsvText text = read_csv_text("joints.csv");
  EXPECT_EQ(text.file, "joints.csv");
  EXPECT_EQ(text.header, (std::vector<std::string>{"target", "q1_rad"}));
  EXPECT_EQ(text.rows, (std::vector<std::vector<std::string>>{{"P 1", "0.10"}, {"P2", ""}}));
  EXPECT_EQ(text.lines, (std::vector<Index>{3, 4}));
  write_file("joints.csv", "target,q1_rad\nP1\n");
  EXPECT_EQ(vernier_test::complaint([] { (void)read_csv_text("joints.csv"); }),
            "joints.csv, line 2: 1 values, the header has 2");
}

}  // namespace
}  // namespace vernier::point_table_test
