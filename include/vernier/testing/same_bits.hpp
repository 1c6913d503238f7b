// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Equality without tolerance, for the laws of repeatability.

#include <bit>
#include <cstdint>

#include "vernier/core/types.hpp"

/// Law suites: what every type that claims a concept must do. They return violations and need no test framework.
namespace vernier::testing {

/// Whether two matrices have one shape and the same bits; two values that are not numbers may be equal.
inline bool same_bits(const Eigen::Ref<const MatrixX>& a, const Eigen::Ref<const MatrixX>& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  for (Index j = 0; j < a.cols(); ++j)
    for (Index i = 0; i < a.rows(); ++i)
      if (std::bit_cast<std::uint64_t>(a(i, j)) != std::bit_cast<std::uint64_t>(b(i, j))) return false;
  return true;
}

}  // namespace vernier::testing
