// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/least_squares/detail/visit_blocks.hpp"
#include "vernier/least_squares/leave_one_out.hpp"

namespace vernier {

namespace detail {

/// Predicts all blocks of a pose from those of other poses.
/// @return whitened errors, six a block
VERNIER_LOCAL VectorX leave_out(const BlockSystem& system, const FactorisedEquations& solved,
                                const std::vector<Index>& blocks) {
  const auto size = static_cast<Index>(6 * blocks.size());
  std::vector<RowBlock> rows(blocks.size());
  MatrixX columns(system.unknowns(), size), rest = MatrixX::Identity(size, size);
  VectorX residual(size);
  Rows6 expanded(6, system.unknowns());
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Index at = static_cast<Index>(6 * k);
    system.rows(blocks[k], 1, &rows[k]);
    rows[k].expand(system.group_sizes, expanded);
    Vector6 here = rows[k].residual;
    add_columns(expanded, solved.step().data(), 1, here.data());
    if (system.local_states > 0) {
      for (const RowBlock::Local& part : rows[k].local)
        if (part.state >= 0)
          add_columns(part.columns, &solved.local_step()(part.state * system.local_size), 1, here.data());
      solved.eliminate_local(rows[k], expanded);
    }
    for (Index i = 0; i < 6; ++i) {
      residual(at + i) = here(i);
      for (Index c = 0; c < expanded.cols(); ++c) columns(c, at + i) = expanded(i, c);
    }
  }
  solved.apply_inverse_factor(columns);
  add_transposed_product(rest, columns, columns, -1);
  if (system.local_states > 0) rest -= solved.joint_local_gains(rows);
  solve_general(rest, residual);
  return residual;
}

/// The validation blocks of each pose that has several.
VERNIER_LOCAL std::vector<std::vector<Index>> repeated_poses(const std::vector<Index>& poses) {
  std::vector<std::vector<Index>> blocks;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const auto pose = static_cast<std::size_t>(poses[b]);
    if (pose >= blocks.size()) blocks.resize(pose + 1);
    blocks[pose].push_back(static_cast<Index>(b));
  }
  std::erase_if(blocks, [](const std::vector<Index>& of_pose) { return of_pose.size() < 2; });
  return blocks;
}

}  // namespace detail

VERNIER_IMPL LeftOutBlocks leave_one_out(const BlockSystem& system, const FactorisedEquations& solved, Index stride) {
  const Index size = (system.validation_blocks + stride - 1) / stride;
  LeftOutBlocks out{Eigen::Matrix3Xd(3, size)};
  for (Index b = 0; b < size && !system.poses.empty(); ++b)
    out.poses.push_back(system.poses[static_cast<std::size_t>(b * stride)]);
  std::fill_n(out.errors.data(), 3 * size, std::numeric_limits<double>::infinity());
  if (!solved.usable()) return out;
  constexpr Index batch = 32;
  const bool local = system.local_states > 0;
  solved.executor().for_ranges((size + batch - 1) / batch, [&](Index from, Index to) {
    std::vector<RowBlock> kept;
    Rows6 expanded(6, system.unknowns());
    MatrixX columns(system.unknowns(), 6 * batch), gains, rest;
    std::array<Vector6, batch> residuals;
    std::array<Matrix6, batch> unwhiten;
    VectorX sigmas(batch);
    for (Index first = from * batch; first < (std::min)(to * batch, size); first += batch) {
      const Index n = (std::min)(batch, size - first);
      kept.clear();
      detail::visit_blocks(system, first * stride, stride, n, [&](Index b, const RowBlock& rows) {
        rows.expand(system.group_sizes, expanded);
        const auto k = static_cast<std::size_t>(b);
        residuals[k] = rows.residual;
        detail::add_columns(expanded, solved.step().data(), 1, residuals[k].data());
        if (local) {
          for (const RowBlock::Local& part : rows.local)
            if (part.state >= 0)
              detail::add_columns(part.columns, &solved.local_step()(part.state * system.local_size), 1,
                                  residuals[k].data());
          solved.eliminate_local(rows, expanded);
          kept.push_back(rows);
        }
        unwhiten[k] = rows.unwhiten;
        sigmas(b) = rows.position_sigma;
        for (Index i = 0; i < 6; ++i)
          for (Index c = 0; c < expanded.cols(); ++c) columns(c, 6 * b + i) = expanded(i, c);
      });
      solved.apply_inverse_factor(VERNIER_LATER(columns).leftCols(6 * n));
      if (local) gains = solved.local_gains(kept);
      for (Index b = 0; b < n; ++b) {
        const auto z = VERNIER_LATER(columns).middleCols(6 * b, 6);
        rest.setIdentity(6, 6);
        detail::add_transposed_product(rest, z, z, -1);
        if (local) rest -= VERNIER_LATER(gains).middleCols(6 * b, 6);
        const auto k = static_cast<std::size_t>(b);
        Vector6 left_out = residuals[k];
        detail::solve_general(rest, left_out);
        const Vector6 error = unwhiten[k] * left_out;
        for (Index r = 0; r < 3; ++r) out.errors(r, first + b) = sigmas(b) * error(r);
      }
    }
  });
  const std::vector<std::vector<Index>> repeated = detail::repeated_poses(system.poses);
  solved.executor().for_ranges(static_cast<Index>(repeated.size()), [&](Index from, Index to) {
    RowBlock block;
    for (Index p = from; p < to; ++p) {
      const std::vector<Index>& blocks = repeated[static_cast<std::size_t>(p)];
      if (std::none_of(blocks.begin(), blocks.end(), [&](Index b) { return b % stride == 0; })) continue;
      const VectorX errors = detail::leave_out(system, solved, blocks);
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        if (blocks[k] % stride != 0) continue;
        const Index b = blocks[k] / stride;
        system.rows(blocks[k], 1, &block);
        Vector6 left_out;
        for (Index r = 0; r < 6; ++r) left_out(r) = errors(static_cast<Index>(6 * k) + r);
        const Vector6 error = block.unwhiten * left_out;
        for (Index r = 0; r < 3; ++r) out.errors(r, b) = block.position_sigma * error(r);
      }
    }
  });
  return out;
}

VERNIER_IMPL Eigen::Matrix3Xd leave_one_out_errors(const BlockSystem& system, const FactorisedEquations& solved,
                                                   Index stride) {
  return leave_one_out(system, solved, stride).errors;
}

VERNIER_IMPL VectorX detail::error_norms(const Eigen::Matrix3Xd& errors) {
  VectorX out(errors.cols());
  for (Index b = 0; b < out.size(); ++b) out(b) = Vector3(errors(0, b), errors(1, b), errors(2, b)).norm();
  return out;
}

VERNIER_IMPL VectorX detail::error_norms(const LeftOutBlocks& left_out) {
  return means_of_poses(error_norms(left_out.errors), left_out.poses);
}

VERNIER_IMPL VectorX detail::means_of_poses(const VectorX& values, const std::vector<Index>& poses) {
  if (poses.empty()) return values;
  std::map<Index, std::pair<double, Index>> sums;  // and number of each pose
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto& [sum, count] = sums[poses[i]];
    sum += values(static_cast<Index>(i));
    ++count;
  }
  VectorX out(static_cast<Index>(sums.size()));
  Index at = 0;
  for (const auto& [pose, mean] : sums) out(at++) = mean.first / static_cast<double>(mean.second);
  return out;
}

}  // namespace vernier
