// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/data/ordered_rows.hpp"

namespace vernier {

VERNIER_IMPL bool rows_are_ordered(const ConstMatrixRef& joints) {
  const Index n = joints.rows();
  constexpr Index few = 10;
  if (n < few) return false;
  std::vector<VectorX> rows;
  for (Index i = 0; i < n; ++i) rows.push_back(detail::row_of(joints, i));
  Rng rng(1);
  std::vector<double> steps, random;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto other = static_cast<std::size_t>(rng.below(static_cast<std::uint64_t>(n)));
    steps.push_back((rows[i] - rows[i - 1]).norm());
    if (other != i) random.push_back((rows[i] - rows[other]).norm());
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  return median(steps) < 0.5 * median(random);
}

}  // namespace vernier
