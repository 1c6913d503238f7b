#pragma once

/// @file
/// The domain of a search.

#include "vernier/core/check.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// Bounds of a search, one interval per dimension.
struct Box {
  VectorX lower;  ///< one a dimension
  VectorX upper;  ///< one a dimension, above the lower one

  /// The cube [lower, upper]^dimension.
  /// @throws std::invalid_argument unless dimension >= 1 and lower < upper
  static Box cube(Index dimension, double lower, double upper) {
    require(dimension >= 1, "Box::cube: dimension is ", dimension, ", must be at least 1");
    require(lower < upper, "Box::cube: lower bound ", lower, " is not below upper bound ", upper);
    return {VectorX::Constant(dimension, lower), VectorX::Constant(dimension, upper)};
  }

  /// Number of dimensions.
  Index dimension() const { return lower.size(); }
  /// Whether x lies within, bounds included.
  bool contains(const Eigen::Ref<const VectorX>& x) const {
    return x.size() == dimension() && (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
  }

  /// @throws std::invalid_argument unless both bounds are finite, of one size, and lower < upper everywhere
  void validate() const {
    require(lower.size() == upper.size() && lower.size() >= 1, "Box: ", lower.size(), " lower and ", upper.size(),
            " upper bounds");
    for (Index i = 0; i < lower.size(); ++i)
      require(lower(i) < upper(i) && upper(i) - lower(i) < 1e300, "Box: dimension ", i, " has bounds [", lower(i), ", ",
              upper(i), "], must be finite and lower below upper");
  }
};

}  // namespace vernier
