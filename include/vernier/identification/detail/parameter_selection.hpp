// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Which candidates of an identification are independent of each other.

#include <vector>

#include "vernier/identification/identifiable_parameters.hpp"

namespace vernier::detail {

/// `IdentifiableParameters` by candidate.
struct ParameterSelection {
  /// A candidate that depends on others.
  struct Dependent {
    Index parameter;
    std::vector<Index> absorbed_by;
  };
  std::vector<Index> base;           ///< independent ones
  std::vector<Dependent> dependent;  ///< the others

  /// @param candidates that the columns belong to
  VERNIER_LOCAL ParameterSelection(const std::vector<Index>& candidates, const MatrixX& jacobian) {
    const IdentifiableParameters columns(jacobian);
    const auto parameters = [&](const std::vector<Index>& which) {
      std::vector<Index> out;
      for (const Index k : which) out.push_back(candidates[static_cast<std::size_t>(k)]);
      return out;
    };
    base = parameters(columns.base);
    for (const auto& d : columns.dependent)
      dependent.push_back({candidates[static_cast<std::size_t>(d.column)], parameters(d.absorbed_by)});
  }
};

}  // namespace vernier::detail
