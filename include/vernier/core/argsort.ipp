// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/argsort.hpp"

#include <algorithm>
#include <numeric>

#include "vernier/core/same_value.hpp"

namespace vernier {

VERNIER_IMPL std::vector<Index> argsort(const ConstVectorRef& values) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return !same_value(values(a), values(b)) ? values(a) < values(b) : a < b; });
  return order;
}

}  // namespace vernier
