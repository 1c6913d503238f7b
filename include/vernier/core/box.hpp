// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The domain of a search.

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Bounds of a search, one interval per dimension.
struct Box {
  VectorX lower;  ///< one per dimension
  VectorX upper;  ///< one per dimension, above the lower one

  /// The cube [lower, upper]^dimension.
  /// @throws std::invalid_argument unless dimension >= 1 and lower < upper
  VERNIER_API static Box cube(Index dimension, double lower, double upper);

  /// Number of dimensions.
  Index dimension() const { return lower.size(); }
  /// Whether x lies within, bounds included.
  VERNIER_API bool contains(const ConstVectorRef& x) const;

  /// @throws std::invalid_argument unless both bounds are finite, of one size, and lower < upper everywhere
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/core/box.ipp"
#endif
