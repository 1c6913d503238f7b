// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Products of narrow tiles, `A'B` over samples, for the normal equations of hidden layers.
///
/// A tile has one row a sample; rows are `stride` apart, a multiple of 8. Per sample the product costs stride^2
/// multiply-adds on stride loaded numbers, so a block of accumulators kept in registers makes it arithmetic-bound.

#include "vernier/core/simd.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// `left' diag(weights) right` over all samples.
struct WeightedProduct {
  const double* left;     // samples rows of `stride`
  const double* right;    // samples rows of `stride`
  const double* weights;  // samples
  double* tile;           // tile_samples rows of `stride`, scratch
  double* products;       // stride x stride, added to
  Index samples, stride, tile_samples;
  bool symmetric;  // left is right
};

/// Adds `left' diag(weights) right` with the instructions of `set`, which must be there.
VERNIER_API void add_weighted_product(const WeightedProduct& p, InstructionSet set);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/tile_product.ipp"
#endif
