// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Blocks of a least-squares problem, evaluated a few at a time.

#include <algorithm>
#include <vector>

#include "vernier/least_squares/row_block.hpp"

namespace vernier::detail {

/// How many blocks are evaluated at a time: their Jacobians stay in the cache.
inline constexpr Index rows_at_a_time = 16;

/// Calls `use(index, block)` for blocks first, first + stride, ...: `count` of them.
template <class Use>
void visit_blocks(const BlockSystem& system, Index first, Index stride, Index count, const Use& use) {
  std::vector<RowBlock> rows(static_cast<std::size_t>(stride == 1 ? rows_at_a_time : 1));
  for (Index next = 0; next < count; next += static_cast<Index>(rows.size())) {
    const Index n = (std::min)(static_cast<Index>(rows.size()), count - next);
    system.rows(first + next * stride, n, rows.data());
    for (Index b = 0; b < n; ++b) use(next + b, rows[static_cast<std::size_t>(b)]);
  }
}

/// Adds `factor columns x` to six values.
VERNIER_API inline void add_columns(const Rows6& columns, const double* x, double factor, double* out) {
  double sum[6] = {};
  for (Index j = 0; j < columns.cols(); ++j)
    for (Index r = 0; r < 6; ++r) sum[r] += x[j] * columns(r, j);
  for (Index r = 0; r < 6; ++r) out[r] += factor * sum[r];
}

}  // namespace vernier::detail
