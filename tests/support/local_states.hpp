#pragma once

/// @file
/// A small least-squares problem with coupled local states, and its dense solution.

#include <algorithm>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/least_squares/normal_equations.hpp"

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
    const MatrixX walk = 3 * MatrixX::Identity(size, size);
    MatrixX turn = walk;  // not symmetric
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
  MatrixX matrix() const {
    MatrixX out = jacobian().transpose() * jacobian();
    out.diagonal().head(dense) += precisions;
    out.bottomRightCorner(states * size, states * size) += prior();
    return out;
  }
  /// The gradient of all unknowns with priors.
  VectorX gradient() const {
    VectorX out = jacobian().transpose() * residual();
    out.head(dense) += precisions.cwiseProduct(steps);
    out.tail(states * size) += prior() * local_steps;
    return out;
  }

  /// Residuals of all blocks.
  VectorX residual() const {
    VectorX out(6 * blocks);
    for (Index b = 0; b < blocks; ++b) out.segment(6 * b, 6) = rows[static_cast<std::size_t>(b)].residual;
    return out;
  }
  /// Columns of all unknowns, dense ones first.
  MatrixX jacobian() const {
    MatrixX out = MatrixX::Zero(6 * blocks, dense + states * size);
    for (Index b = 0; b < blocks; ++b) {
      const vernier::RowBlock& row = rows[static_cast<std::size_t>(b)];
      out.block(6 * b, 0, 6, dense) = row.dense;
      for (const auto& part : row.local)
        if (part.state >= 0) out.block(6 * b, dense + part.state * size, 6, size) += part.columns;
    }
    return out;
  }
  /// Precisions of the local unknowns.
  MatrixX prior() const {
    MatrixX out = MatrixX::Zero(states * size, states * size);
    for (const auto& p : priors) {
      out.block(p.first * size, p.second * size, size, size) += p.precision;
      if (p.first != p.second) out.block(p.second * size, p.first * size, size, size) += p.precision.transpose();
    }
    return out;
  }
};

}  // namespace vernier_test
