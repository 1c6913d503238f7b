// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sorting by index.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// Indices of values in ascending order; equal values keep their order. Values must be comparable: none may be NaN.
/// @complexity O(n log n)
VERNIER_API std::vector<Index> argsort(const ConstVectorRef& values);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/argsort.ipp"
#endif
