// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Splits into training and test rows: random, every k-th, contiguous blocks, by region of space, by time. All rows
/// that visit one pose (`pose_numbers`) lie on the side of the first of them: a reading repeated tells nothing new. If
/// no pose would be held out so, those with a held-out row are.

#include <cstdint>
#include <vector>

#include "vernier/data/dataset.hpp"
#include "vernier/data/same_pose.hpp"

namespace vernier {

/// Training and test samples; disjoint, together all samples.
template <int N>
struct Split {
  Dataset<N> train;  ///< in ascending row order
  Dataset<N> test;   ///< likewise
};

/// Options of `split`.
struct SplitOptions {
  double test_fraction = 0.2;  ///< fraction of rows held out, in (0, 1)
  std::uint64_t seed = 0;      ///< of the shuffle
};

/// A face of the bounding box of the measured positions.
enum class Face { x_low, x_high, y_low, y_high, z_low, z_high };

/// Options of `split_region`.
struct RegionOptions {
  double test_fraction = 0.2;  ///< fraction of rows held out, in (0, 1)
  Face face = Face::x_high;    ///< the rows nearest to this face are held out
};

namespace detail {

/// Rows of a split, ascending.
struct SplitRows {
  std::vector<Index> train, test;
};
VERNIER_API SplitRows random_rows(Index n, const SplitOptions& options);
VERNIER_API SplitRows every_kth_row(Index n, Index k);
VERNIER_API SplitRows rows_of_block(Index n, Index block, Index blocks);
VERNIER_API SplitRows region_rows(const PointRows& positions, const RegionOptions& options);
VERNIER_API SplitRows last_rows(Index n, double test_fraction);
VERNIER_API std::vector<Index> first_random_rows(Index size, Index n, std::uint64_t seed);

/// A split with all rows of a pose on the side of its first row.
/// @throws std::invalid_argument where a side would have no row
VERNIER_API SplitRows with_whole_poses(const SplitRows& rows, const ConstMatrixRef& joints, const SamePose& same);

template <int N>
Split<N> split_at(const Dataset<N>& data, const SplitRows& rows, const SamePose& same) {
  const SplitRows whole = with_whole_poses(rows, data.joints(), same);
  return {data.rows(whole.train), data.rows(whole.test)};
}

}  // namespace detail

/// Random rows held out. Optimistic where samples are dense: test rows have neighbours among the training rows.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split(const Dataset<N>& data, const SplitOptions& options = {}, const SamePose& same = {}) {
  return detail::split_at(data, detail::random_rows(data.size(), options), same);
}

/// Every k-th row held out: row i is a test row when i % k == 0.
/// @throws std::invalid_argument for k < 2 or fewer than 2 rows
template <int N>
Split<N> split_every(const Dataset<N>& data, Index k, const SamePose& same = {}) {
  return detail::split_at(data, detail::every_kth_row(data.size(), k), same);
}

/// One of some contiguous blocks of rows held out, whose sizes differ by one row at most: tests drift in both
/// directions.
/// @param data   to split
/// @param block  which of the blocks, from 0
/// @param blocks their number
/// @param same   within which joint values rows are one pose
/// @throws std::invalid_argument unless blocks is in [2, data.size()] and block in [0, blocks)
template <int N>
Split<N> split_block(const Dataset<N>& data, Index block, Index blocks = 5, const SamePose& same = {}) {
  return detail::split_at(data, detail::rows_of_block(data.size(), block, blocks), same);
}

/// The rows nearest to one face of the bounding box held out: tests extrapolation in space.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split_region(const Dataset<N>& data, const RegionOptions& options = {}, const SamePose& same = {}) {
  return detail::split_at(data, detail::region_rows(data.positions(), options), same);
}

/// The last rows held out: tests drift over time, which row order stands for.
/// @throws std::invalid_argument for fewer than 2 rows or a fraction outside (0, 1)
template <int N>
Split<N> split_time(const Dataset<N>& data, double test_fraction = 0.2, const SamePose& same = {}) {
  return detail::split_at(data, detail::last_rows(data.size(), test_fraction), same);
}

/// The first n samples of a seeded shuffle, in its order: of one seed, fewer samples are always among more.
/// @throws std::invalid_argument unless n is in [1, data.size()]
template <int N>
Dataset<N> random_subset(const Dataset<N>& data, Index n, std::uint64_t seed) {
  return data.rows(detail::first_random_rows(data.size(), n, seed));
}

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/data/split.ipp"
#endif
