#pragma once

/// @file
/// What a search found when.

#include <chrono>
#include <limits>
#include <vector>

#include "vernier/core/fit_options.hpp"

namespace vernier {

/// An observer that writes down the best value against evaluations and time, and asks another observer whether to go
/// on. `SearchLog log; minimize(pso, objective, box, {}, 1, {}, log);` One log may see several calls in a row that go
/// on with one search: a generation seen twice is one entry, and time runs on.
class SearchLog {
 public:
  /// One generation.
  struct Entry {
    Index generation = 0;   ///< generations done
    Index evaluations = 0;  ///< objective evaluations done
    double best = 0;        ///< best value so far
    double seconds = 0;     ///< since the log was made, on a clock that never goes back
  };

  /// @param next asked after every entry; must outlive this
  explicit SearchLog(ObserverRef next = {}) : next_(next) {}

  /// Writes down; what the other observer says.
  bool operator()(const Progress& progress) {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - started_;
    if (entries_.empty() || entries_.back().generation != progress.generation)
      entries_.push_back({progress.generation, progress.evaluations, progress.best, since.count()});
    return next_(progress);
  }

  /// Everything so far, in the order it came.
  const std::vector<Entry>& entries() const { return entries_; }

  /// Best value known after so many evaluations; infinity before the first entry.
  double best_after(Index evaluations) const {
    double best = std::numeric_limits<double>::infinity();
    for (const Entry& entry : entries_)
      if (entry.evaluations <= evaluations) best = entry.best;
    return best;
  }

  /// Evaluations after which a value was reached, as seen at the end of a generation; -1 where it never was.
  Index evaluations_to(double target) const {
    for (const Entry& entry : entries_)
      if (entry.best <= target) return entry.evaluations;
    return -1;
  }

 private:
  ObserverRef next_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::vector<Entry> entries_;
};

}  // namespace vernier
