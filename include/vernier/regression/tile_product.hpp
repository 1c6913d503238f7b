#pragma once

/// @file
/// Products of narrow tiles, `A'B` over samples: what the normal equations of hidden layers are made of.
///
/// A tile has one row a sample; rows are `stride` apart, a multiple of 8. Per sample the product costs stride^2
/// multiply-adds on stride loaded numbers, so a block of accumulators kept in registers makes it arithmetic-bound.

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

template <int W, int Rows, int Vectors>
VERNIER_INLINE void weighted_product_kernel(const WeightedProduct& p) {
  for (Index begin = 0; begin < p.samples; begin += p.tile_samples) {
    const Index samples = std::min(p.tile_samples, p.samples - begin);
    for (Index s = 0; s < samples; ++s) {
      const double weight = p.weights[begin + s];
      const double* from = p.left + (begin + s) * p.stride;
      double* to = p.tile + s * p.stride;
      for (Index k = 0; k < p.stride; k += W) {
        typename Simd<W>::Double v;
        load<W>(v, from + k);
        v *= weight;
        store<W>(to + k, v);
      }
    }
    tile_product<W, Rows, Vectors>(p.tile, p.right + begin * p.stride, p.products, p.stride, samples, p.symmetric);
  }
}

/// Adds `left' diag(weights) right` with the instructions of `set`, which must be there.
inline void add_weighted_product(const WeightedProduct& p, InstructionSet set) {
  run_widest([&]<int W>() VERNIER_INLINED { weighted_product_kernel<W, block_rows<W>, block_vectors<W>>(p); }, set);
}

}  // namespace vernier::detail
