// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Identifiable (base) parameters: columns of an identification Jacobian that are linearly independent.

#include <vector>

#include "vernier/core/types.hpp"

namespace vernier {

/// The linearly independent columns of a Jacobian, given an order of preference, and what the others depend on.
/// @cite Khalil and Gautier 1991
struct IdentifiableParameters {
  /// A linearly dependent column.
  struct Dependent {
    Index column;                    ///< of the Jacobian
    std::vector<Index> absorbed_by;  ///< columns that it depends on; empty: it is zero
  };
  std::vector<Index> base;           ///< independent columns, in order of preference
  std::vector<Dependent> dependent;  ///< the others

  /// @param jacobian  rows x columns, columns scaled to expected sizes, in order of preference
  /// @param tolerance a column is dependent when the share of it that is orthogonal to the columns before is smaller
  VERNIER_API explicit IdentifiableParameters(const ConstMatrixRef& jacobian, double tolerance = 1e-7);
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/identification/identifiable_parameters.ipp"
#endif
