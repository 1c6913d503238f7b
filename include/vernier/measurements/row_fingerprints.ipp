// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/measurements/row_fingerprints.hpp"

namespace vernier {
namespace detail {

/// Mixes a value into a hash, counted in steps of a size. Cells begin at an odd share of a step, so that decimal
/// values, which files have, lie on no border.
VERNIER_LOCAL std::uint64_t mixed(std::uint64_t hash, double value, double step) {
  const double cell = std::floor(value / step + 0.3183098861837907);
  const auto count = static_cast<std::int64_t>(std::clamp(cell, -9e18, 9e18));
  hash = (hash ^ static_cast<std::uint64_t>(count)) * 0x9E3779B97F4A7C15u;  // the golden ratio
  return hash ^ (hash >> 32);
}

VERNIER_LOCAL std::uint32_t fingerprint(const ConstMatrixRef& joints, const ConstMatrixRef& positions, Index row) {
  constexpr double joint_step = 1e-6, position_step = 1e-7;  // [rad, m]; [m]
  std::uint64_t hash = 0;
  for (Index j = 0; j < joints.cols(); ++j) hash = mixed(hash, joints(row, j), joint_step);
  for (Index k = 0; k < positions.cols(); ++k) hash = mixed(hash, positions(row, k), position_step);
  return static_cast<std::uint32_t>(hash >> 32);
}

}  // namespace detail

VERNIER_IMPL RowFingerprints::RowFingerprints(const ConstMatrixRef& joints, const ConstMatrixRef& positions) {
  demand(joints.rows() == positions.rows(), "RowFingerprints: ", joints.rows(), " rows of joints and ",
         positions.rows(), " positions");
  for (Index i = 0; i < joints.rows(); ++i) sorted_.push_back(detail::fingerprint(joints, positions, i));
  std::sort(sorted_.begin(), sorted_.end());
}

VERNIER_IMPL RowFingerprints::RowFingerprints(std::vector<std::uint32_t> values) : sorted_(std::move(values)) {
  std::sort(sorted_.begin(), sorted_.end());
}

VERNIER_IMPL void RowFingerprints::add(const RowFingerprints& other) {
  sorted_.insert(sorted_.end(), other.sorted_.begin(), other.sorted_.end());
  std::sort(sorted_.begin(), sorted_.end());
}

VERNIER_IMPL std::vector<Index> RowFingerprints::others(const ConstMatrixRef& joints,
                                                        const ConstMatrixRef& positions) const {
  std::vector<Index> out;
  for (Index i = 0; i < joints.rows(); ++i)
    if (!std::binary_search(sorted_.begin(), sorted_.end(), detail::fingerprint(joints, positions, i)))
      out.push_back(i);
  return out;
}

}  // namespace vernier
