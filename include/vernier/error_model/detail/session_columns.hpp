// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A problem with the motions of a session as ordinary columns, so that what moved with time can be told from the rest.

#include <vector>

#include "vernier/error_model/detail/model_selection.hpp"

namespace vernier::detail {

/// A problem whose knots of drift are replaced by slow functions of time: of each set and each component of its drift,
/// cosines of up to eight half periods, less the higher they are, as in a random walk.
class SessionColumns {
 public:
  /// @param model with a drift of bases, or of joints' zeros as well; must outlive this, unchanged
  VERNIER_API explicit SessionColumns(const ModelSelection& model);

  /// Tests unknowns of the problem beside the drift.
  /// @param group counted as in the problem
  VERNIER_API ScoreTest beside_drift(const UnknownGroup& group) const;
  /// Tests the drift of components first .. end - 1 beside that of those before them.
  VERNIER_API ScoreTest of_drift(Index first, Index end) const;

  /// Evaluates blocks first .. first + count - 1 with the columns in the place of knots.
  VERNIER_API void operator()(Index first, Index count, RowBlock* out) const;

 private:
  static constexpr Index half_periods = 8;
  /// The place in the extended problem.
  Index place(Index unknown) const { return unknown < dense_ ? unknown : unknown + added_; }
  VERNIER_API ScoreTest test(const UnknownGroup& group, Index components) const;

  const ModelSelection& model_;
  Index dense_, added_, size_;  // of the problem; columns that are added; components of a knot
  std::vector<Index> set_;      // of each block, counted among those that drift; negative for none
  VectorX phase_;               // of each block, from 0 at the start of its session to 1 at its end
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/detail/session_columns.ipp"
#endif
