// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Convergence history of a search.

#include <vector>

#include "vernier/core/fit_options.hpp"

namespace vernier {

/// An observer that records the best value against evaluations and time, and returns what another observer returns.
/// `SearchLog log; minimize(pso, objective, box, {}, 1, {}, log);` One log may observe several calls in a row that
/// resume one search: a generation seen twice is one entry, and time runs on.
class SearchLog {
 public:
  /// One generation.
  struct Entry {
    Index generation = 0;   ///< generations done
    Index evaluations = 0;  ///< objective evaluations done
    double best = 0;        ///< best value so far
    double seconds = 0;     ///< since the log was constructed, by a monotonic clock
  };

  /// @param next called after every entry; must outlive this
  VERNIER_API explicit SearchLog(ObserverRef next = {});

  /// Records an entry; returns what the other observer returns.
  VERNIER_API bool operator()(const Progress& progress);

  /// All entries, in order.
  const std::vector<Entry>& entries() const { return entries_; }

  /// Best value after that many evaluations; infinity before the first entry.
  VERNIER_API double best_after(Index evaluations) const;

  /// Number of evaluations after which `target` was reached, at the end of a generation; -1 where it never was.
  VERNIER_API Index evaluations_to(double target) const;

 private:
  ObserverRef next_;
  double started_;  // [s]
  std::vector<Entry> entries_;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/log.ipp"
#endif
