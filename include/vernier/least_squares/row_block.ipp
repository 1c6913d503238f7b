#pragma once

#include "vernier/least_squares/row_block.hpp"

namespace vernier {

VERNIER_IMPL void RowBlock::expand(const std::vector<Index>& group_sizes, Eigen::Ref<Rows6> out) const {
  out.leftCols(dense.cols()) = dense;
  Index at = 0;
  for (std::size_t j = 0; j < group_sizes.size(); ++j) {
    if (group_sizes[j] == 0) continue;
    out.middleCols(dense.cols() + at, group_sizes[j]).noalias() =
        factor.col(static_cast<Index>(j)) * functions.segment(at, group_sizes[j]).transpose();
    at += group_sizes[j];
  }
}

}  // namespace vernier
