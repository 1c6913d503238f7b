#pragma once

/// @file
/// Places of values in rising order.

#include <algorithm>
#include <numeric>
#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Indices of values in rising order, equal values in the order they have. Values must be comparable: none may be NaN.
inline std::vector<Index> argsort(const Eigen::Ref<const VectorX>& values) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return values(a) != values(b) ? values(a) < values(b) : a < b; });
  return order;
}

}  // namespace vernier
