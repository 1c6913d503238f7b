// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/data/split.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vernier/core/argsort.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::detail {

/// Number of rows held out of n; at least one on each side.
VERNIER_LOCAL Index num_test_rows(const char* caller, Index n, double fraction) {
  demand(fraction > 0 && fraction < 1, caller, ": test_fraction is ", fraction, ", must lie strictly between 0 and 1");
  demand(n >= 2, caller, ": ", n, " rows cannot be split, at least 2 are needed");
  return std::clamp<Index>(static_cast<Index>(std::llround(fraction * static_cast<double>(n))), 1, n - 1);
}

/// The first rows of an order as test rows, the others as training rows.
VERNIER_LOCAL SplitRows split_order(std::vector<Index> order, Index tests) {
  std::sort(order.begin(), order.begin() + tests);
  std::sort(order.begin() + tests, order.end());
  return {{order.begin() + tests, order.end()}, {order.begin(), order.begin() + tests}};
}

VERNIER_IMPL SplitRows random_rows(Index n, const SplitOptions& options) {
  const Index tests = num_test_rows("split", n, options.test_fraction);
  return split_order(Rng(options.seed).permutation(n), tests);
}

VERNIER_IMPL SplitRows every_kth_row(Index n, Index k) {
  demand(k >= 2, "split_every: k is ", k, ", must be at least 2");
  demand(n >= 2, "split_every: ", n, " rows cannot be split, at least 2 are needed");
  SplitRows out;
  for (Index i = 0; i < n; ++i) (i % k == 0 ? out.test : out.train).push_back(i);
  return out;
}

VERNIER_IMPL SplitRows rows_of_block(Index n, Index block, Index blocks) {
  demand(blocks >= 2 && blocks <= n, "split_block: ", blocks, " blocks of ", n, " rows, must be 2 to ", n);
  demand(block >= 0 && block < blocks, "split_block: block is ", block, ", must be 0 to ", blocks - 1);
  SplitRows out;
  for (Index i = 0; i < n; ++i) (i * blocks / n == block ? out.test : out.train).push_back(i);
  return out;
}

VERNIER_IMPL SplitRows region_rows(const PointRows& positions, const RegionOptions& options) {
  const Index n = positions.rows(), tests = num_test_rows("split_region", n, options.test_fraction);
  const int axis = static_cast<int>(options.face) / 2;
  const double sign = static_cast<int>(options.face) % 2 == 0 ? 1 : -1;
  const VectorX along = VERNIER_LATER(positions).col(axis);
  return split_order(argsort(sign * along), tests);
}

VERNIER_IMPL SplitRows last_rows(Index n, double test_fraction) {
  const Index tests = num_test_rows("split_time", n, test_fraction);
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.rbegin(), order.rend(), Index{0});
  return split_order(std::move(order), tests);
}

VERNIER_IMPL SplitRows with_whole_poses(const SplitRows& rows, const ConstMatrixRef& joints, const SamePose& same) {
  const std::vector<Index> poses = pose_numbers(joints, same);
  std::vector<bool> held_out(poses.size(), false), seen(poses.size(), false), test(poses.size(), false);
  for (const Index row : rows.test) test[static_cast<std::size_t>(row)] = true;
  const auto sides = [&] {
    SplitRows out;
    for (std::size_t i = 0; i < poses.size(); ++i)
      (held_out[static_cast<std::size_t>(poses[i])] ? out.test : out.train).push_back(static_cast<Index>(i));
    return out;
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto pose = static_cast<std::size_t>(poses[i]);
    if (!seen[pose]) held_out[pose] = test[i];
    seen[pose] = true;
  }
  SplitRows out = sides();
  if (out.test.empty()) {  // every held-out row repeats an earlier pose
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (test[i]) held_out[static_cast<std::size_t>(poses[i])] = true;
    out = sides();
  }
  demand(!out.train.empty() && !out.test.empty(), "split: the ", poses.size(),
         " rows visit too few poses to hold some of them out: all rows of a pose stay together");
  return out;
}

VERNIER_IMPL std::vector<Index> first_random_rows(Index size, Index n, std::uint64_t seed) {
  demand(n >= 1 && n <= size, "random_subset: ", n, " rows of ", size);
  std::vector<Index> order = Rng(seed).permutation(size);
  order.resize(static_cast<std::size_t>(n));
  return order;
}

}  // namespace vernier::detail
