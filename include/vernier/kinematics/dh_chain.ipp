// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/kinematics/dh_chain.hpp"

namespace vernier::detail {

/// Names and kinds of a chain's parameters, row by row.
VERNIER_IMPL std::vector<std::string> chain_parameter_names(int joints) {
  std::vector<std::string> names;
  for (int i = 1; i <= joints; ++i)
    for (const char* name : {"a", "alpha", "d", "theta", "beta"}) names.push_back(message(name, i));
  return names;
}

VERNIER_IMPL std::vector<ParameterKind> chain_parameter_kinds(int joints) {
  std::vector<ParameterKind> kinds;
  for (int i = 0; i < joints; ++i)
    for (int k = 0; k < 5; ++k) kinds.push_back(k == 0 || k == 2 ? ParameterKind::length : ParameterKind::angle);
  return kinds;
}

}  // namespace vernier::detail
