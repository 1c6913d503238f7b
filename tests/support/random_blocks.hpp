// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Least-squares problems of random numbers, in blocks.

#include <utility>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier_test {

using vernier::BlockSystem;
using vernier::Index;
using vernier::Matrix3;
using vernier::MatrixX;
using vernier::NormalEquations;
using vernier::Rng;
using vernier::RowBlock;
using vernier::Rows6;
using vernier::Vector3;
using vernier::VectorX;

template <class M>
void fill(Rng& rng, M&& m, double size = 1) {
  for (Index j = 0; j < m.cols(); ++j)
    for (Index i = 0; i < m.rows(); ++i) m(i, j) = size * rng.normal();
}

inline VectorX random_vector(Rng& rng, Index n, double size = 1) {
  VectorX out(n);
  fill(rng, out, size);
  return out;
}
/// Squares of random numbers, added to a least one.
inline VectorX random_squares(Rng& rng, Index n, double least = 0) {
  VectorX out(n);
  for (double& x : out) {
    const double root = rng.normal();
    x = least + root * root;
  }
  return out;
}

/// Blocks of random numbers.
struct RandomBlocks {
  std::vector<Index> group_sizes{4, 0, 6};
  Index dense = 5;
  std::vector<RowBlock> rows;

  /// @param plain whether residuals are whitened by the identity
  RandomBlocks(Index blocks, std::uint64_t seed, bool plain = true, Index dense_unknowns = 5) : dense(dense_unknowns) {
    Rng rng(seed);
    for (Index b = 0; b < blocks; ++b) {
      RowBlock p;
      fill(rng, p.residual);
      p.dense.resize(6, dense);
      fill(rng, p.dense);
      p.factor.resize(6, 3);
      fill(rng, p.factor);
      p.functions.resize(10);
      fill(rng, p.functions);
      p.unwhiten.setIdentity();
      if (!plain) {
        fill(rng, p.unwhiten, 0.3);
        for (Index k = 0; k < 6; ++k) p.unwhiten(k, k) += 1;
        p.position_sigma = rng.uniform(0.01, 1);
      }
      rows.push_back(p);
    }
  }

  const RowBlock& row(Index b) const { return rows[static_cast<std::size_t>(b)]; }
  Index size() const { return static_cast<Index>(rows.size()); }
  Index unknowns() const { return dense + 10; }
  Rows6 expanded(Index b) const {
    Rows6 out(6, unknowns());
    row(b).expand(group_sizes, out);
    return out;
  }
  template <class F>
  decltype(auto) with_system(F&& f) const {
    const auto get = [this](Index first, Index count, RowBlock* out) {
      for (Index b = 0; b < count; ++b) out[b] = row(first + b);
    };
    return f(BlockSystem{size(), size(), dense, group_sizes, get});
  }
  NormalEquations normal() const {
    return with_system([](const BlockSystem& s) { return NormalEquations(s); });
  }
};

/// Position error of a block that took no part: the regularised problem solved again without it.
inline Vector3 left_out_by_force(const RandomBlocks& blocks, const VectorX& precisions, const VectorX& steps,
                                 Index without) {
  RealMatrix matrix = RealMatrix::diagonal(precisions), gradient = matrix * steps;
  for (Index b = 0; b < blocks.size(); ++b) {
    if (b == without) continue;
    const RealMatrix rows = blocks.expanded(b);
    matrix += rows.transpose() * rows;
    gradient += rows.transpose() * blocks.row(b).residual;
  }
  const RealMatrix step = -matrix.solve_by_cholesky(gradient);
  const RowBlock& p = blocks.row(without);
  const RealMatrix error = p.unwhiten * (p.residual + blocks.expanded(without) * step) * p.position_sigma;
  return {error(0), error(1), error(2)};
}

}  // namespace vernier_test
