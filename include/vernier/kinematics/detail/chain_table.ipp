// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/kinematics/detail/chain_table.hpp"

namespace vernier::detail {

VERNIER_IMPL ChainTable::ChainTable(std::vector<DhRow> rows, bool modified)
    : rows_(std::move(rows)), modified_(modified) {
  demand(!rows_.empty() && rows_.size() <= max_joints, "a chain of ", rows_.size(), " joints, must have 1 to ",
         max_joints);
  for (const DhRow& row : rows_) {
    theta_.push_back(row.theta);
    turning_.push_back(row.joint == JointType::revolute ? 1 : 0);
    twist_.push_back(constexpr_sincos(row.alpha));
    hayati_.push_back(constexpr_sincos(row.beta));
  }
}

VERNIER_IMPL ChainTable::ChainTable(const ChainView& chain)
    : ChainTable(std::vector<DhRow>(chain.rows, chain.rows + chain.joints), chain.modified) {}

}  // namespace vernier::detail
