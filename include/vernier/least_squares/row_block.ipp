// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/least_squares/row_block.hpp"

namespace vernier {

VERNIER_IMPL void RowBlock::expand(const std::vector<Index>& group_sizes, Rows6& out) const {
  std::copy_n(dense.data(), dense.size(), out.data());
  Index at = 0;
  for (std::size_t j = 0; j < group_sizes.size(); ++j) {
    if (group_sizes[j] == 0) continue;
    const Vector6 common = detail::column_of(factor, static_cast<Index>(j));
    for (const Index end = at + group_sizes[j]; at < end; ++at)
      for (Index r = 0; r < 6; ++r) out(r, dense.cols() + at) = common(r) * functions(at);
  }
}

}  // namespace vernier
