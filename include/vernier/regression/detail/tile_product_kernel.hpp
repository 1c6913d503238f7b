// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The kernel of `tile_product.hpp`: only definitions include it.

#include <algorithm>

#include "vernier/core/simd.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Rows and vectors of a block of accumulators: they fill the registers, 8 x 3 of 32, 4 x 3 of 16.
template <int W>
inline constexpr int block_rows = W == 8 ? 8 : 4;
template <int W>
inline constexpr int block_vectors = W == 2 ? 2 : 3;

/// Adds rows i .. i+Rows of the product, columns j .. j+Vectors*W.
template <int W, int Rows, int Vectors>
VERNIER_INLINE void product_block(const double* left, const double* right_tile, double* products, Index stride,
                                  Index samples, Index i, Index j) {
  typename Simd<W>::Double sum[Rows][Vectors], right[Vectors];
  double* product = products + i * stride + j;
  VERNIER_UNROLL
  for (int r = 0; r < Rows; ++r) {
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) load<W>(sum[r][v], product + r * stride + v * W);
  }
  for (Index s = 0; s < samples; ++s) {
    const double *left_row = left + s * stride, *right_row = right_tile + s * stride;
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) load<W>(right[v], right_row + j + v * W);
    VERNIER_UNROLL
    for (int r = 0; r < Rows; ++r) {
      VERNIER_UNROLL
      for (int v = 0; v < Vectors; ++v) sum[r][v] += left_row[i + r] * right[v];
    }
  }
  VERNIER_UNROLL
  for (int r = 0; r < Rows; ++r) {
    VERNIER_UNROLL
    for (int v = 0; v < Vectors; ++v) store<W>(product + r * stride + v * W, sum[r][v]);
  }
}

/// Adds `left' right`, stride x stride by rows; of a symmetric product only the blocks on and right of the diagonal.
template <int W, int Rows, int Vectors>
VERNIER_INLINE void tile_product(const double* left, const double* right, double* products, Index stride, Index samples,
                                 bool symmetric) {
  for (Index i = 0; i < stride; i += Rows) {
    Index j = symmetric ? i / W * W : 0;
    for (; j + Vectors * W <= stride; j += Vectors * W)
      product_block<W, Rows, Vectors>(left, right, products, stride, samples, i, j);
    for (; j < stride; j += W) product_block<W, Rows, 1>(left, right, products, stride, samples, i, j);
  }
}

}  // namespace vernier::detail
