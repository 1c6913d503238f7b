// Files and lines of rows, as messages name them.

#include "vernier/data/row_origin.hpp"

#include <gtest/gtest.h>

#include <array>

#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/identification/stations.hpp"

namespace vernier::row_origin_test {
namespace {

TEST(RowOrigin, NamesRowsOfNoFileOneFileAndSeveral) {
  const RowOrigin none, one = RowOrigin::of("a.csv", {2, 3, 7});
  EXPECT_EQ(none.where(4), "row 4");
  EXPECT_EQ(none.where(std::vector<Index>{4}), "row 4");
  EXPECT_EQ(none.where({1, 3, 6}), "rows 1, 3 and 6");
  EXPECT_EQ(one.where(2), "a.csv, line 7");
  EXPECT_EQ(one.where(std::vector<Index>{2}), "a.csv, line 7");
  EXPECT_EQ(one.where({0, 1, 2}), "a.csv, lines 2, 3 and 7");
  EXPECT_EQ(none.where({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}), "rows 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, ... (11 rows)");
  RowOrigin both = one;
  both.append(RowOrigin::of("b.csv", {9}), 3);
  EXPECT_EQ(both.where(3), "b.csv, line 9");
  EXPECT_EQ(both.where({0, 3}), "a.csv, line 2 and b.csv, line 9");
  EXPECT_EQ(both.rows(std::array<Index, 2>{3, 0}).where(0), "b.csv, line 9");
  both.append(none, 4);
  EXPECT_TRUE(both.empty());
}

TEST(RowOrigin, SurvivesReadingSplittingAndJoining) {
  const vernier_test::TemporaryFolder folder("row_origin");
  const std::string file = (folder.path() / "poses.csv").string();
  write_file(file, "q1_rad,q2_rad,x_mm,y_mm,z_mm\n\n0,0,1,2,3\n1,0,1,2,3\n\n2,0,1,2,3\n");
  const auto data = read_dataset<2>(file);
  EXPECT_EQ(data.origin().line, (std::vector<Index>{3, 4, 6}));
  const auto [train, test] = split_every(data, 2);
  EXPECT_EQ(train.origin().where(0), file + ", line 4");
  EXPECT_EQ(test.origin().where(1), file + ", line 6");
  const std::vector<Dataset<2>> both{train, test};
  const auto joined = in_one_frame<2>(both, {Isometry3::Identity(), Isometry3::Identity()});
  EXPECT_EQ(joined.origin().line, (std::vector<Index>{4, 3, 6}));
}

}  // namespace
}  // namespace vernier::row_origin_test
