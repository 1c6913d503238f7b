#pragma once

#include "vernier/core/argsort.hpp"

#include <algorithm>
#include <numeric>

namespace vernier {

VERNIER_IMPL std::vector<Index> argsort(const ConstVectorRef& values) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return values(a) != values(b) ? values(a) < values(b) : a < b; });
  return order;
}

}  // namespace vernier
