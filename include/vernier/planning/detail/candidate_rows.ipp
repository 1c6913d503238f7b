// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/core/detail/dense.hpp"
#include "vernier/planning/detail/candidate_rows.hpp"

namespace vernier::detail {

VERNIER_IMPL bool CandidateRows::finite() const {
  return all_finite(dense) && all_finite(factors) && all_finite(functions);
}

VERNIER_IMPL MatrixX CandidateRows::columns(Index first, Index count) const {
  const Index few = dense.rows();
  MatrixX out(unknowns(), count * block);
  for (Index k = 0; k < out.cols(); ++k) {
    const Index from = first * block + k;
    double* column = std::copy_n(dense.data() + few * from, few, out.data() + out.rows() * k);
    const double* function = functions.data() + functions.rows() * (from / block);
    for (std::size_t j = 0; j < groups.size(); ++j)
      for (Index i = 0; i < groups[j]; ++i) *column++ = factors(static_cast<Index>(j), from) * *function++;
  }
  return out;
}

VERNIER_IMPL MatrixX CandidateRows::products(const ConstMatrixRef& directions, Index first, Index count) const {
  const Index few = dense.rows(), n = directions.cols();
  MatrixX out = MatrixX::Zero(n, count * block), sums(n, count);
  add_transposed_product(out, VERNIER_LATER(directions).topRows(few),
                         VERNIER_LATER(dense).middleCols(first * block, count * block));
  Index begin = 0;
  for (std::size_t j = 0; j < groups.size(); begin += groups[j++]) {
    if (groups[j] == 0) continue;
    sums.setZero();
    add_transposed_product(sums, VERNIER_LATER(directions).middleRows(few + begin, groups[j]),
                           VERNIER_LATER(functions).block(begin, first, groups[j], count));
    for (Index k = 0; k < out.cols(); ++k) {
      const double factor = factors(static_cast<Index>(j), first * block + k);
      const double* sum = sums.data() + n * (k / block);
      double* column = out.data() + n * k;
      for (Index i = 0; i < n; ++i) column[i] += factor * sum[i];
    }
  }
  return out;
}

}  // namespace vernier::detail
