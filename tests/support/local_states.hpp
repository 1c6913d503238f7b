// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A small least-squares problem with coupled local states, and its dense solution.

#include <algorithm>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier_test {

using vernier::Index;
using vernier::MatrixX;
using vernier::VectorX;

/// Random blocks of which each depends on up to two of a few local states, a random walk as their prior; dense
/// unknowns beside them.
struct LocalStates {
  static constexpr Index dense = 4, states = 7, size = 3, blocks = 40;
  std::vector<vernier::RowBlock> rows;
  std::vector<vernier::LocalPrior> priors;
  VectorX precisions = VectorX::Constant(dense, 0.7), steps, local_steps;

  explicit LocalStates(std::uint64_t seed) {
    vernier::Rng rng(seed);
    const auto fill = [&](auto&& values) {
      for (Index c = 0; c < values.cols(); ++c)
        for (Index r = 0; r < values.rows(); ++r) values(r, c) = rng.normal();
    };
    for (Index b = 0; b < blocks; ++b) {
      vernier::RowBlock row;
      fill(row.residual);
      row.dense.resize(6, dense);
      fill(row.dense);
      row.factor.resize(6, 0);
      row.unwhiten.setIdentity();
      for (int k = 0; k < 2 && b % 5 != 0; ++k) {  // every fifth block depends on none
        row.local[static_cast<std::size_t>(k)] = {(b + k) % states, vernier::Rows6(6, size)};
        fill(row.local[static_cast<std::size_t>(k)].columns);
      }
      rows.push_back(std::move(row));
    }
    const RealMatrix walk = 3 * RealMatrix::identity(size);
    RealMatrix turn = walk;  // not symmetric
    turn(0, 1) = 0.4;
    priors.push_back({0, 0, 2 * walk});
    for (Index k = 0; k + 1 < states; ++k) {
      priors.push_back({k, k, 1.5 * walk});
      if (k % 2 == 0)  // either order
        priors.push_back({k + 1, k, -turn});
      else
        priors.push_back({k, k + 1, -turn});
      priors.push_back({k + 1, k + 1, 1.5 * walk});
    }
    steps.resize(dense);
    local_steps.resize(states * size);
    fill(steps);
    fill(local_steps);
  }

  vernier::NormalEquations normal_equations() const {
    const auto evaluate = [this](Index first, Index count, vernier::RowBlock* out) {
      std::copy_n(rows.begin() + first, count, out);
    };
    return vernier::NormalEquations(vernier::BlockSystem{blocks, blocks, dense, {}, evaluate, states, size}, priors);
  }

  /// The matrix of all unknowns with priors, dense ones first.
  RealMatrix matrix() const { return jacobian().transpose() * jacobian() + prior(precisions); }
  /// The gradient of all unknowns with priors.
  RealMatrix gradient() const { return jacobian().transpose() * residual() + prior(precisions) * all_steps(); }

  /// Steps of all unknowns, dense ones first.
  RealMatrix all_steps() const {
    RealMatrix out(dense + states * size, 1);
    out.set_block(0, 0, steps);
    out.set_block(dense, 0, local_steps);
    return out;
  }
  /// Residuals of all blocks.
  RealMatrix residual() const {
    RealMatrix out(6 * blocks, 1);
    for (Index b = 0; b < blocks; ++b) out.set_block(6 * b, 0, rows[static_cast<std::size_t>(b)].residual);
    return out;
  }
  /// Columns of all unknowns, dense ones first.
  RealMatrix jacobian() const {
    RealMatrix out(6 * blocks, dense + states * size);
    for (Index b = 0; b < blocks; ++b) {
      const vernier::RowBlock& row = rows[static_cast<std::size_t>(b)];
      out.set_block(6 * b, 0, row.dense);
      for (const auto& part : row.local)
        if (part.state >= 0) out.add_block(6 * b, dense + part.state * size, part.columns);
    }
    return out;
  }
  /// Precisions of all unknowns.
  /// @param of_dense those of the dense ones
  RealMatrix prior(const VectorX& of_dense) const {
    RealMatrix out(dense + states * size, dense + states * size);
    out.set_block(0, 0, RealMatrix::diagonal(of_dense));
    for (const auto& p : priors) {
      const Index a = dense + p.first * size, b = dense + p.second * size;
      out.add_block(a, b, p.precision);
      if (a != b) out.add_block(b, a, RealMatrix(p.precision).transpose());
    }
    return out;
  }
};

}  // namespace vernier_test
