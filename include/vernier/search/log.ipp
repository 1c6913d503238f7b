// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "vernier/core/detail/steady_seconds.hpp"
#include "vernier/search/log.hpp"

namespace vernier {

VERNIER_IMPL SearchLog::SearchLog(ObserverRef next) : next_(next), started_(detail::steady_seconds()) {}

VERNIER_IMPL bool SearchLog::operator()(const Progress& progress) {
  if (entries_.empty() || entries_.back().generation != progress.generation)
    entries_.push_back({progress.generation, progress.evaluations, progress.best, detail::steady_seconds() - started_});
  return next_(progress);
}

VERNIER_IMPL double SearchLog::best_after(Index evaluations) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Entry& entry : entries_)
    if (entry.evaluations <= evaluations) best = entry.best;
  return best;
}

VERNIER_IMPL Index SearchLog::evaluations_to(double target) const {
  for (const Entry& entry : entries_)
    if (entry.best <= target) return entry.evaluations;
  return -1;
}

}  // namespace vernier
