// SPDX-License-Identifier: BSD-3-Clause
// Files and lines of rows, as messages name them.

#include "vernier/data/row_origin.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <fstream>
#include <thread>

#include "temporary_folder.hpp"
#include "vernier/core/atomic_file.hpp"
#include "vernier/core/sha256.hpp"
#include "vernier/data/csv.hpp"
#include "vernier/data/split.hpp"
#include "vernier/identification/in_one_frame.hpp"

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
  EXPECT_EQ(joined.origin().hashes, std::vector<std::string>(2, sha256(read_file(file))));
}

TEST(RowOrigin, HashesStandBesideTheirFiles) {
  RowOrigin by_hand{.files = {"a.csv", "b.csv"}, .file = {0, 1}, .line = {1, 1}};
  by_hand.append(RowOrigin::of("c.csv", {2}, "c's"), 2);
  EXPECT_EQ(by_hand.files, (std::vector<std::string>{"a.csv", "b.csv", "c.csv"}));
  EXPECT_EQ(by_hand.hashes, (std::vector<std::string>{"", "", "c's"}));
  EXPECT_EQ(by_hand.rows(std::array<Index, 1>{2}).hashes, by_hand.hashes);
}

// Whatever reads rows knows the bytes that it read, also of a pipe, which nobody can read again.
TEST(RowOrigin, HashesAreOfWhatCameThroughAPipe) {
  const vernier_test::TemporaryFolder folder("row_origin_pipe");
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto origin_of = [&](const std::string& text, const auto& read) {
    std::jthread writer([&] { std::ofstream(pipe, std::ios::binary) << text; });
    const RowOrigin out = read();
    EXPECT_EQ(out.hashes, std::vector<std::string>{sha256(text)});
    return out.where(0);
  };
  EXPECT_EQ(
      origin_of("q1_rad,x_mm,y_mm,z_mm\n0,1,2,3\n", [&] { return read_dataset<1>(pipe).without_approach().origin(); }),
      pipe + ", line 2");
  EXPECT_EQ(
      origin_of("\xEF\xBB\xBFq1_rad,distance_mm\r\n\r\n0,1\r\n", [&] { return read_distances<1>(pipe).origin(); }),
      pipe + ", line 3");
  EXPECT_EQ(origin_of("q1_rad,contact_id,kind\n0,a,socket\n1,a,socket\n",
                      [&] { return read_contacts(pipe, 1).front().origin(); }),
            pipe + ", line 2");
}

}  // namespace
}  // namespace vernier::row_origin_test
