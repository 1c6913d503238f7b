// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "vernier/regression/detail/tile_product.hpp"
#include "vernier/regression/detail/tile_product_kernel.hpp"

namespace vernier::detail {

template <int W, int Rows, int Vectors>
VERNIER_INLINE void weighted_product_kernel(const WeightedProduct& p) {
  for (Index begin = 0; begin < p.samples; begin += p.tile_samples) {
    const Index samples = (std::min)(p.tile_samples, p.samples - begin);
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

VERNIER_IMPL void add_weighted_product(const WeightedProduct& p, InstructionSet set) {
  run_widest([&]<int W>() VERNIER_INLINED { weighted_product_kernel<W, block_rows<W>, block_vectors<W>>(p); }, set);
}

}  // namespace vernier::detail
