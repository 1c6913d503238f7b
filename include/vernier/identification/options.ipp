// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "vernier/core/check.hpp"
#include "vernier/identification/options.hpp"

namespace vernier {

VERNIER_IMPL void IdentifyOptions::validate(const std::vector<std::string>& names) const {
  for (const auto& [name, value] : {std::pair{"length_prior_std", length_prior_std},
                                    {"angle_prior_std", angle_prior_std},
                                    {"joint_zero_prior_std", joint_zero_prior_std}})
    demand(value > 0 && std::isfinite(value), "IdentifyOptions: ", name, " is ", value, ", must be positive");
  demand(max_iterations >= 1, "IdentifyOptions: max_iterations is ", max_iterations, ", must be at least 1");
  for (const auto& name : fixed)
    demand(std::find(names.begin(), names.end(), name) != names.end(), "IdentifyOptions: no parameter is called '",
           name, "'; they are called like ", names.front(), " or ", names[names.size() / 2]);
}

namespace detail {

VERNIER_IMPL std::vector<int> parallel_rows(const ChainTable& chain) {
  const bool modified = chain.modified();
  const int n = chain.joints();
  std::vector<int> rows;
  for (int i = modified ? 1 : 0; i < (modified ? n : n - 1); ++i) {
    const DhRow& row = chain.rows()[static_cast<std::size_t>(i)];
    if (std::abs(std::sin(row.alpha)) < 0.02 && std::abs(std::sin(row.beta)) < 0.02 && chain.revolute(i) &&
        chain.revolute(modified ? i - 1 : i + 1))
      rows.push_back(i);
  }
  return rows;
}

}  // namespace detail
}  // namespace vernier
