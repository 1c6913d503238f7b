// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Rows of many candidate measurements, of which most columns are products of few numbers.

#include <vector>

#include "vernier/core/fit_options.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Thrown through planning that is to end, and caught there.
struct PlanningStopped {};

/// Reports to an observer.
/// @throws PlanningStopped where it requests a stop
inline void report_planning(const ObserverRef& observer, const Progress& progress) {
  if (!observer(progress)) throw PlanningStopped();
}

/// Whitened rows of n candidates, as many each, transposed. Unknowns are dense ones, then groups of factored ones, as
/// in `RowBlock`: entry (unknown k of group j, row r of candidate c) is `factors(j, c block + r) functions(k, c)`. A
/// group of m functions thus takes m numbers a candidate, not m block.
struct CandidateRows {
  Index block = 1;              ///< rows a candidate, 1 to 6
  MatrixX dense{};              ///< dense unknowns x n block
  MatrixX factors{};            ///< groups x n block
  MatrixX functions{};          ///< functions of all groups x n
  std::vector<Index> groups{};  ///< number of functions of each group

  /// Number of candidates.
  Index size() const { return dense.cols() / block; }
  /// Number of unknowns.
  Index unknowns() const { return dense.rows() + functions.rows(); }
  /// Whether no number is infinite or not a number.
  VERNIER_API bool finite() const;
  /// The rows of some candidates as columns, unknowns x count block.
  VERNIER_API MatrixX columns(Index first, Index count) const;
  /// Products of some directions and those columns, directions x count block.
  /// @param directions unknowns x any number
  VERNIER_API MatrixX products(const ConstMatrixRef& directions, Index first, Index count) const;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/planning/detail/candidate_rows.ipp"
#endif
