// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A chain whose number of joints is known at run time.

#include <vector>

#include "vernier/kinematics/detail/chain_walk.hpp"

namespace vernier::detail {

/// What `ChainRows` is for a number of joints known at compile time.
class ChainTable {
 public:
  ChainTable() = default;
  /// @param rows 1 to `max_joints`
  VERNIER_API ChainTable(std::vector<DhRow> rows, bool modified);
  /// The rows that a view points to.
  VERNIER_API explicit ChainTable(const ChainView& chain);

  int joints() const { return static_cast<int>(rows_.size()); }
  bool modified() const { return modified_; }
  const std::vector<DhRow>& rows() const { return rows_; }
  bool revolute(int joint) const { return rows_[static_cast<std::size_t>(joint)].joint == JointType::revolute; }
  ChainView view() const {
    return {joints(), modified_, rows_.data(), theta_.data(), turning_.data(), twist_.data(), hayati_.data()};
  }

 private:
  std::vector<DhRow> rows_;
  bool modified_ = false;
  std::vector<double> theta_, turning_;
  std::vector<SinCos> twist_, hayati_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/kinematics/detail/chain_table.ipp"
#endif
