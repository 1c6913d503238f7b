// SPDX-License-Identifier: BSD-3-Clause
#include "vernier/planning/visiting_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "complaint.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::visiting_order_test {
namespace {

MatrixX random_configurations(Index n, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(n, 6);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < 6; ++j) out(i, j) = rng.uniform(-3, 3);
  return out;
}

TEST(VisitingOrder, NearlyTheShortestOfAllPaths) {
  double ratios = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const MatrixX joints = random_configurations(9, seed);
    std::vector<Index> order(9);
    std::iota(order.begin(), order.end(), Index{0});
    double shortest = path_time(joints, order);
    while (std::next_permutation(order.begin() + 1, order.end()))
      shortest = std::min(shortest, path_time(joints, order));
    const std::vector<Index> found = visiting_order(joints);
    EXPECT_EQ(found.front(), 0);
    std::vector<Index> sorted = found;
    std::sort(sorted.begin(), sorted.end());
    for (Index i = 0; i < 9; ++i) EXPECT_EQ(sorted[static_cast<std::size_t>(i)], i);
    const double ratio = path_time(joints, found) / shortest;
    EXPECT_GE(ratio, 1 - 1e-12);
    EXPECT_LE(ratio, 1.15) << "seed " << seed;
    ratios += ratio / 10;
  }
  EXPECT_LE(ratios, 1.05);
}

TEST(VisitingOrder, AStraightLineIsFollowed) {
  MatrixX joints(6, 2);
  joints << 0, 0, 3, 0, 1, 0, 5, 0, 2, 0, 4, 0;
  EXPECT_EQ(visiting_order(joints), (std::vector<Index>{0, 2, 4, 1, 5, 3}));
}

TEST(VisitingOrder, FirstRowsStay) {
  const std::vector<Index> order = visiting_order(random_configurations(100, 3), VectorX(), 3);
  EXPECT_EQ(std::vector<Index>(order.begin(), order.begin() + 3), (std::vector<Index>{0, 1, 2}));
}

TEST(VisitingOrder, TheSlowestJointDecides) {
  MatrixX joints(2, 2);
  joints << 0, 0, 1, 3;
  EXPECT_DOUBLE_EQ(path_time(joints, {0, 1}), 3);
  EXPECT_DOUBLE_EQ(path_time(joints, {0, 1}, Eigen::Vector2d(0.25, 2)), 4);
}

/// From one visit to another by the slowest joint; nothing leads on from the last.
double time_between(const MatrixX& joints, const std::vector<Index>& order, Index a, Index b) {
  if (b >= static_cast<Index>(order.size())) return 0;
  return (joints.row(order[static_cast<std::size_t>(a)]) - joints.row(order[static_cast<std::size_t>(b)]))
      .cwiseAbs()
      .maxCoeff();
}

void expect_no_reversal_shortens(const MatrixX& joints, const std::vector<Index>& order) {
  const auto time = [&](Index a, Index b) { return time_between(joints, order, a, b); };
  for (Index i = 1; i < joints.rows(); ++i)
    for (Index j = i + 1; j < joints.rows(); ++j)
      EXPECT_GE(time(i - 1, j) + time(i, j + 1), time(i - 1, i) + time(j, j + 1) - 1e-9) << i << ' ' << j;
}

// One to three visits between any two others, in either direction: none would make the way shorter.
TEST(VisitingOrder, NoFewVisitsAreBetterElsewhere) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const MatrixX joints = random_configurations(150, seed).leftCols(2);
    const std::vector<Index> order = visiting_order(joints);
    const auto n = static_cast<Index>(order.size());
    const auto time = [&](Index a, Index b) { return time_between(joints, order, a, b); };
    for (Index length = 1; length <= 3; ++length)
      for (Index i = 1; i + length <= n; ++i)
        for (Index j = 0; j < n; ++j) {
          const Index last = i + length - 1;
          if (j >= i - 1 && j <= last) continue;
          const double saved = time(i - 1, i) + time(last, last + 1) - time(i - 1, last + 1);
          const double forth = time(j, i) + time(last, j + 1), back = time(j, last) + time(i, j + 1);
          EXPECT_GE(std::min(forth, back) - time(j, j + 1), saved - 1e-9) << length << ' ' << i << ' ' << j;
        }
  }
}

// The same for many small sets: whatever a sweep changes, reversed or moved, the next one looks at.
TEST(VisitingOrder, ManySmallPathsCannotBeShortened) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const MatrixX joints = random_configurations(12 + static_cast<Index>(seed % 9), seed).leftCols(2);
    const std::vector<Index> order = visiting_order(joints);
    expect_no_reversal_shortens(joints, order);
  }
}

// The search begins with the path to the nearest configuration again and again, so it ends with none that is longer.
TEST(VisitingOrder, NoLongerThanByNearestNeighbours) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const MatrixX joints = random_configurations(8, seed).leftCols(2);
    std::vector<Index> greedy{0}, left{1, 2, 3, 4, 5, 6, 7};
    while (!left.empty()) {
      auto nearest = left.begin();
      for (auto at = left.begin(); at != left.end(); ++at)
        if (path_time(joints, {greedy.back(), *at}) < path_time(joints, {greedy.back(), *nearest})) nearest = at;
      greedy.push_back(*nearest);
      left.erase(nearest);
    }
    EXPECT_LE(path_time(joints, visiting_order(joints)), path_time(joints, greedy) + 1e-9) << seed;
  }
}

TEST(VisitingOrder, OneConfigurationOrNone) {
  using vernier_test::complaint;
  const MatrixX one = random_configurations(1, 1);
  EXPECT_EQ(visiting_order(one), std::vector<Index>{0});
  EXPECT_EQ(visiting_order(one, VectorX(), 0), std::vector<Index>{0});
  EXPECT_EQ(complaint([&] { (void)visiting_order(one, VectorX(), 2); }),
            "visiting_order: 2 of 1 rows are to stay first");
  EXPECT_EQ(complaint([] { (void)visiting_order(MatrixX(0, 6), VectorX(), 2); }),
            "visiting_order: 2 of 0 rows are to stay first");
  EXPECT_EQ(path_time(one, {0}), 0);
  EXPECT_TRUE(with_check_visits({}, 1).empty());
  EXPECT_EQ(with_check_visits({5, 6}, 1), (std::vector<Index>{5, 5, 6, 5}));
}

TEST(VisitingOrder, ChecksAreRepeated) {
  EXPECT_EQ(with_check_visits({4, 1, 2, 3, 0}, 2), (std::vector<Index>{4, 1, 4, 2, 3, 4, 0, 4}));
  EXPECT_EQ(with_check_visits({7}, 2), (std::vector<Index>{7}));
  EXPECT_EQ(with_check_visits({3, 7}, 2), (std::vector<Index>{3, 7, 3}));
}

TEST(VisitingOrder, RefusesWhatIsNotUsable) {
  using vernier_test::complaint;
  const MatrixX joints = random_configurations(4, 1);
  EXPECT_EQ(complaint([&] { (void)visiting_order(joints, VectorX::Ones(5)); }), "visiting_order: 5 speeds of 6 joints");
  EXPECT_EQ(complaint([&] { (void)visiting_order(joints, VectorX::Zero(6)); }),
            "visiting_order: a speed is not positive");
  EXPECT_EQ(complaint([&] { (void)visiting_order(joints, VectorX(), -1); }),
            "visiting_order: -1 of 4 rows are to stay first");
  EXPECT_EQ(visiting_order(joints, VectorX(), 4), (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(complaint([&] { (void)visiting_order(MatrixX::Constant(2, 6, std::nan(""))); }),
            "visiting_order: a joint value is not finite");
  EXPECT_EQ(complaint([&] {
              (void)with_check_visits({0, 1}, 0);
            }),
            "with_check_visits: every is 0, must be at least 1");
  EXPECT_EQ(complaint([&] { (void)visiting_order(joints, VectorX(), 5); }),
            "visiting_order: 5 of 4 rows are to stay first");
  EXPECT_TRUE(visiting_order(MatrixX(0, 6)).empty());
}

}  // namespace
}  // namespace vernier::visiting_order_test
