// SPDX-License-Identifier: BSD-3-Clause
// Splits: disjoint, complete, in row order, and by the documented rule.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>
#include <vernier/core/rng.hpp>
#include <vernier/data/split.hpp>

#include "complaint.hpp"

namespace split_test {
namespace {

using vernier::Dataset;
using vernier::Face;
using vernier::Index;
using vernier::JointRows;
using vernier::PointRows;
using vernier::Split;

/// n rows whose joint is the row number; positions random.
Dataset<1> numbered(Index n, bool oriented = false) {
  vernier::Rng rng(5);
  JointRows<1> q(n, 1);
  PointRows p(n, 3), r(oriented ? n : 0, 3);
  for (Index i = 0; i < n; ++i) q(i, 0) = static_cast<double>(i);
  for (auto& value : p.reshaped()) value = rng.uniform(-1, 1);
  for (auto& value : r.reshaped()) value = rng.uniform(-1, 1);
  return {q, p, r};
}

std::vector<Index> rows_of(const Dataset<1>& data) {
  std::vector<Index> rows;
  for (Index i = 0; i < data.size(); ++i) rows.push_back(static_cast<Index>(data.joints()(i, 0)));
  return rows;
}

/// Both sides ascending, disjoint, together 0..n-1, and each row whole.
void expect_partition(const Split<1>& split, const Dataset<1>& data) {
  const auto train = rows_of(split.train), test = rows_of(split.test);
  EXPECT_TRUE(std::is_sorted(train.begin(), train.end()));
  EXPECT_TRUE(std::is_sorted(test.begin(), test.end()));
  std::set<Index> all(train.begin(), train.end());
  all.insert(test.begin(), test.end());
  EXPECT_EQ(static_cast<Index>(train.size() + test.size()), data.size());
  EXPECT_EQ(static_cast<Index>(all.size()), data.size());
  EXPECT_EQ(*all.begin(), 0);
  EXPECT_EQ(*all.rbegin(), data.size() - 1);
  for (const auto* side : {&split.train, &split.test})
    for (Index i = 0; i < side->size(); ++i) {
      const auto row = static_cast<Index>(side->joints()(i, 0));
      EXPECT_EQ(side->position(i), data.position(row));
      if (data.has_orientations()) {
        EXPECT_EQ(side->orientations().row(i), data.orientations().row(row));
      }
    }
}

TEST(Split, EveryKindIsAPartition) {
  for (const Index n : {2, 3, 7, 100, 1001})
    for (const double fraction : {0.001, 0.2, 0.5, 0.999}) {
      const auto data = numbered(n, n % 2 == 1);
      SCOPED_TRACE(std::to_string(n) + " rows, fraction " + std::to_string(fraction));
      const auto expected =
          std::clamp<Index>(static_cast<Index>(std::llround(fraction * static_cast<double>(n))), 1, n - 1);
      for (const auto& split :
           {vernier::split(data, {.test_fraction = fraction, .seed = 4}), vernier::split_time(data, fraction),
            vernier::split_region(data, {.test_fraction = fraction, .face = Face::y_low})}) {
        expect_partition(split, data);
        EXPECT_EQ(split.test.size(), expected);
      }
    }
}

TEST(Split, EveryKthRowByTheDocumentedRule) {
  const auto data = numbered(23);
  for (const Index k : {2, 3, 5, 22, 23, 40}) {
    const auto split = vernier::split_every(data, k);
    expect_partition(split, data);
    for (const Index row : rows_of(split.test)) EXPECT_EQ(row % k, 0);
    for (const Index row : rows_of(split.train)) EXPECT_NE(row % k, 0);
  }
  EXPECT_EQ(rows_of(vernier::split_every(data, 5).test), (std::vector<Index>{0, 5, 10, 15, 20}));
}

TEST(Split, SeedsDecideAlone) {
  const auto data = numbered(200);
  const auto test_rows = [&](std::uint64_t seed) { return rows_of(vernier::split(data, {.seed = seed}).test); };
  EXPECT_EQ(test_rows(1), test_rows(1));
  EXPECT_NE(test_rows(1), test_rows(2));
  EXPECT_EQ(test_rows(1).size(), 40u);  // the default is a fifth
}

TEST(Split, EveryRowHasTheSameChance) {
  const auto data = numbered(20);
  std::vector<int> drawn(20, 0);
  for (std::uint64_t seed = 0; seed < 2000; ++seed)
    for (const Index row : rows_of(vernier::split(data, {.test_fraction = 0.25, .seed = seed}).test))
      ++drawn[static_cast<std::size_t>(row)];
  // 2000 draws at 1/4: mean 500, standard deviation 19.4; five of them either way
  for (const int count : drawn) EXPECT_NEAR(count, 500, 97);
}

TEST(Split, RegionHoldsOutTheRowsNearestToItsFace) {
  const auto data = numbered(50);
  for (const auto& [face, axis, high] :
       {std::tuple{Face::x_low, 0, false}, std::tuple{Face::x_high, 0, true}, std::tuple{Face::y_low, 1, false},
        std::tuple{Face::y_high, 1, true}, std::tuple{Face::z_low, 2, false}, std::tuple{Face::z_high, 2, true}}) {
    const auto split = vernier::split_region(data, {.test_fraction = 0.3, .face = face});
    expect_partition(split, data);
    ASSERT_EQ(split.test.size(), 15);
    if (high) {
      EXPECT_GT(split.test.positions().col(axis).minCoeff(), split.train.positions().col(axis).maxCoeff());
    } else {
      EXPECT_LT(split.test.positions().col(axis).maxCoeff(), split.train.positions().col(axis).minCoeff());
    }
  }
}

TEST(Split, RegionTakesTheFirstOfEqualRows) {
  const Dataset<1> grid(numbered(20).joints(), PointRows::Constant(20, 3, 0.5));
  const auto split = vernier::split_region(grid, {.test_fraction = 0.2, .face = Face::z_high});
  EXPECT_EQ(rows_of(split.test), (std::vector<Index>{0, 1, 2, 3}));
}

TEST(Split, TimeHoldsOutTheLastRows) {
  EXPECT_EQ(rows_of(vernier::split_time(numbered(10), 0.3).test), (std::vector<Index>{7, 8, 9}));
  EXPECT_EQ(rows_of(vernier::split_time(numbered(10)).train), (std::vector<Index>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(Split, BlocksAreContiguousAndTogetherAllRows) {
  EXPECT_EQ(rows_of(vernier::split_block(numbered(11), 0, 3).test), (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(rows_of(vernier::split_block(numbered(11), 1, 3).test), (std::vector<Index>{4, 5, 6, 7}));
  EXPECT_EQ(rows_of(vernier::split_block(numbered(11), 2, 3).test), (std::vector<Index>{8, 9, 10}));
  for (Index block = 0; block < 5; ++block) expect_partition(vernier::split_block(numbered(13), block), numbered(13));
  EXPECT_EQ(rows_of(vernier::split_block(numbered(10), 4).test), rows_of(vernier::split_time(numbered(10)).test));
}

template <class F>
void expect_complaint(const F& f, const char* part) {
  const std::string said = vernier_test::complaint(f);
  EXPECT_NE(said.find(part), std::string::npos) << said;
}

TEST(Split, BadFractionsAreNamed) {
  const auto data = numbered(10);
  for (const auto& [fraction, text] :
       {std::pair{0.0, "test_fraction is 0"}, std::pair{1.0, "test_fraction is 1"}, std::pair{-0.5, "-0.5"},
        std::pair{1.5, "1.5"}, std::pair{std::nan(""), "nan"}}) {
    expect_complaint([&, f = fraction] { (void)vernier::split(data, {.test_fraction = f}); }, text);
    expect_complaint([&, f = fraction] { (void)vernier::split_region(data, {.test_fraction = f}); }, text);
    expect_complaint([&, f = fraction] { (void)vernier::split_time(data, f); }, text);
  }
  expect_complaint([&] { (void)vernier::split_every(data, 1); }, "k is 1");
  expect_complaint([&] { (void)vernier::split_every(data, -3); }, "k is -3");
  expect_complaint([&] { (void)vernier::split_block(data, 5); }, "block is 5, must be 0 to 4");
  expect_complaint([&] { (void)vernier::split_block(data, -1); }, "block is -1");
  expect_complaint([&] { (void)vernier::split_block(data, 0, 1); }, "1 blocks of 10 rows");
  expect_complaint([&] { (void)vernier::split_block(data, 0, 11); }, "11 blocks of 10 rows");
}

TEST(Split, OneRowCannotBeSplit) {
  const auto one = numbered(1);
  expect_complaint([&] { (void)vernier::split(one); }, "1 rows");
  expect_complaint([&] { (void)vernier::split_time(one); }, "1 rows");
  expect_complaint([&] { (void)vernier::split_region(one); }, "1 rows");
  expect_complaint([&] { (void)vernier::split_every(one, 2); }, "1 rows");
  expect_complaint([&] { (void)vernier::split(Dataset<1>{}); }, "0 rows");
}

}  // namespace
}  // namespace split_test
