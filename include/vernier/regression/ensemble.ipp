// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "vernier/core/rng.hpp"
#include "vernier/regression/ensemble.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<Index> draw_rows(Index n, double share, bool replacement, std::uint64_t seed) {
  Rng rng(seed);
  const auto count = static_cast<std::size_t>((std::max)(1.0, std::round(share * static_cast<double>(n))));
  std::vector<Index> rows;
  if (replacement) {
    while (rows.size() < count) rows.push_back(static_cast<Index>(rng.below(static_cast<std::uint64_t>(n))));
  } else {
    rows = rng.permutation(n);
    rows.resize(count);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

}  // namespace vernier::detail
