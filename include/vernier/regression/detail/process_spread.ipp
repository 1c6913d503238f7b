// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/dense.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/detail/process_spread.hpp"

namespace vernier::detail {

VERNIER_IMPL LowerInverseTiles::LowerInverseTiles(const MatrixX& factor) {
  const Index n = factor.rows();
  rows_ = (n + size - 1) / size;
  tiles_.assign(static_cast<std::size_t>(rows_ * (rows_ + 1) / 2 * size * size), 0.0);
  MatrixX columns;
  for (Index j = 0; j < rows_; ++j) {  // a tile's columns of the inverse are zero above it
    const Index first = j * size, rest = n - first, width = (std::min)(size, rest);
    columns = MatrixX::Identity(rest, width);
    solve_lower(VERNIER_LATER(factor).bottomRightCorner(rest, rest), columns);
    for (Index i = j; i < rows_; ++i) {
      const Index height = (std::min)(size, n - i * size);
      for (Index c = 0; c < width; ++c)
        std::copy_n(&columns(i * size - first, c), height, tiles_.data() + offset(i, j) + c * size);
    }
  }
}

VERNIER_IMPL LowerInverseTiles::LowerInverseTiles(std::vector<double> values) : tiles_(std::move(values)) {
  while (offset(rows_, 0) < tiles_.size()) ++rows_;
  demand(offset(rows_, 0) == tiles_.size(), "LowerInverseTiles: ", tiles_.size(), " values are no triangle of tiles");
}

/// A tile of values of nodes, zero beyond the last.
VERNIER_LOCAL void fill_tile(const NodeSum& nodes, const double* features, Index first, double* out) noexcept {
  const Index padded = (nodes.nodes() + 7) / 8 * 8, count = (std::min)(LowerInverseTiles::size, padded - first);
  nodes.node_values(features, first, count, out);
  std::fill(out + count, out + LowerInverseTiles::size, 0.0);
}

/// product += tile k.
VERNIER_LOCAL inline void add_tile_product(const double* tile, const double* k, double* product) noexcept {
  run_widest([&]<int W>() VERNIER_INLINED {
    constexpr int vectors = 4;
    typename Simd<W>::Double sum[vectors], part;
    for (Index row = 0; row < LowerInverseTiles::size; row += vectors * W) {
      VERNIER_UNROLL
      for (int v = 0; v < vectors; ++v) load<W>(sum[v], product + row + v * W);
      for (Index column = 0; column < LowerInverseTiles::size; ++column) {
        VERNIER_UNROLL
        for (int v = 0; v < vectors; ++v) {
          load<W>(part, tile + column * LowerInverseTiles::size + row + v * W);
          sum[v] += k[column] * part;
        }
      }
      VERNIER_UNROLL
      for (int v = 0; v < vectors; ++v) store<W>(product + row + v * W, sum[v]);
    }
  });
}

VERNIER_IMPL double LowerInverseTiles::square_of_product(const NodeSum& nodes, const double* features) const noexcept {
  double k[size], total = 0;
  for (Index i = 0; i < rows_; ++i) {
    double product[size] = {};
    for (Index j = 0; j <= i; ++j) {
      fill_tile(nodes, features, j * size, k);
      add_tile_product(tiles_.data() + offset(i, j), k, product);
    }
    for (const double part : product) total += part * part;
  }
  return total;
}

VERNIER_IMPL ProcessSpread::ProcessSpread(const KernelSystem& system, const VectorX& signal_variance,
                                          double noise_ratio)
    : inverse_(system.factor),
      ones_(VectorX::Zero((system.ones.size() + LowerInverseTiles::size - 1) / LowerInverseTiles::size *
                          LowerInverseTiles::size)),
      precision_(system.precision),
      signal_deviation_(VERNIER_LATER(signal_variance).cwiseSqrt()),
      noise_ratio_(noise_ratio) {
  VERNIER_LATER(ones_).head(system.ones.size()) = system.ones;
}

VERNIER_IMPL ProcessSpread::ProcessSpread(const SpreadParts& parts)
    : inverse_(parts.inverse),
      ones_(parts.ones),
      precision_(parts.precision),
      signal_deviation_(parts.signal_deviation),
      noise_ratio_(parts.noise_ratio) {
  demand(ones_.size() == inverse_.rows(), "ProcessSpread: ", ones_.size(), " values for ", inverse_.rows(), " rows");
}

VERNIER_IMPL void ProcessSpread::standard_deviation(const NodeSum& kernels, const double* x, double* out,
                                                    double* workspace) const noexcept {
  constexpr Index tile = LowerInverseTiles::size;
  kernels.features(x, workspace);
  double k[tile], known = 0;  // 1'A^-1 k
  for (Index first = 0; first < kernels.nodes(); first += tile) {
    fill_tile(kernels, workspace, first, k);
    for (Index i = 0; i < tile; ++i) known += ones_(first + i) * k[i];
  }
  const double explained = inverse_.square_of_product(kernels, workspace);
  const double of_mean = (1 - known) * (1 - known) / precision_;
  const double factor = std::sqrt((std::max)(0.0, 1 - explained) + of_mean);
  for (Index o = 0; o < signal_deviation_.size(); ++o) out[o] = signal_deviation_(o) * factor;
}

}  // namespace vernier::detail
