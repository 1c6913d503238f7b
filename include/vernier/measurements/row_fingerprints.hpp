// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows that a model was fitted to, recognised again: a check with them would confirm nothing.

#include <cstdint>
#include <vector>

#include "vernier/core/api.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A number for each row of some measured positions, of 32 bits. Rows have it in any order and number, whichever unit
/// their file has: values that agree to 1e-12 have it in common but for one case in 20,000. A fresh measurement of the
/// same configuration has another one, unless it agrees to a tenth of a micrometre.
class RowFingerprints {
 public:
  /// Those of no rows.
  RowFingerprints() = default;
  /// @param joints    n x joints, of the chain [rad, m]
  /// @param positions n x 3 [m]
  VERNIER_API RowFingerprints(const ConstMatrixRef& joints, const ConstMatrixRef& positions);
  /// @param values as `values` gave them, in any order
  VERNIER_API explicit RowFingerprints(std::vector<std::uint32_t> values);
  /// The numbers in order, one a row.
  const std::vector<std::uint32_t>& values() const { return sorted_; }

  /// Adds rows.
  VERNIER_API void add(const RowFingerprints& other);
  /// Whether there are none.
  bool empty() const { return sorted_.empty(); }
  /// Which of some rows are not among these.
  /// @param joints    n x joints, of the chain [rad, m]
  /// @param positions n x 3 [m]
  /// @complexity O(n log m) for m rows here
  VERNIER_API std::vector<Index> others(const ConstMatrixRef& joints, const ConstMatrixRef& positions) const;
  /// Whether they are of the same rows.
  bool operator==(const RowFingerprints&) const = default;

 private:
  std::vector<std::uint32_t> sorted_{};
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/measurements/row_fingerprints.ipp"
#endif
