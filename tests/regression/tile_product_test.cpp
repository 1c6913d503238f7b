// SPDX-License-Identifier: BSD-3-Clause
// Weighted products of tiles against Eigen, on every instruction set of this machine.

#include "vernier/regression/detail/tile_product.hpp"

#include <gtest/gtest.h>

#include "instruction_sets.hpp"

#include "vernier/core/rng.hpp"

namespace vernier::tile_product_test {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowMatrix uniform(Index rows, Index columns, std::uint64_t seed) {
  Rng rng(seed);
  RowMatrix out(rows, columns);
  for (auto& x : out.reshaped()) x = rng.uniform(-1, 1);
  return out;
}

// Sizes that leave remainders everywhere: samples and the tile, the stride and the blocks of accumulators.
TEST(TileProduct, EqualsThePlainProductOnEveryInstructionSet) {
  for (const auto set : vernier_test::instruction_sets()) {
    for (const Index stride : {8, 16, 24, 40, 72})
      for (const Index samples : {1, 7, 16, 53}) {
        const RowMatrix a = uniform(samples, stride, 1), b = uniform(samples, stride, 2);
        const VectorX weights = uniform(samples, 1, 3).col(0);
        for (const bool symmetric : {false, true}) {
          const RowMatrix& right = symmetric ? a : b;
          const RowMatrix before = uniform(stride, stride, 4);
          RowMatrix tile(8, stride), out = before;
          detail::add_weighted_product({a.data(), right.data(), weights.data(), tile.data(), out.data(), samples,
                                        stride, tile.rows(), symmetric},
                                       set);
          const RowMatrix difference = out - before - a.transpose() * weights.asDiagonal() * right;
          if (symmetric) {
            EXPECT_LT(MatrixX(difference.triangularView<Eigen::Upper>()).cwiseAbs().maxCoeff(), 1e-13);
          } else {
            EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-13);
          }
        }
      }
  }
}

}  // namespace
}  // namespace vernier::tile_product_test
