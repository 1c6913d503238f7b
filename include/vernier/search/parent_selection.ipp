// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/parent_selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier {

VERNIER_IMPL ParentSelector::ParentSelector(ParentSelection selection, int tournament, const VectorX& fitness)
    : fitness_(fitness), tournament_(tournament) {
  if (selection != ParentSelection::roulette) return;
  double worst = -std::numeric_limits<double>::infinity();
  for (const double value : fitness)
    if (std::isfinite(value)) worst = (std::max)(worst, value);
  double sum = 0;
  for (const double value : fitness) wheel_.push_back(sum += std::isfinite(value) ? worst - value : 0);
  if (!(sum > 0 && std::isfinite(sum))) {
    wheel_.clear();
    tournament_ = 1;
  }
}

VERNIER_IMPL Index ParentSelector::operator()(Rng& rng) const {
  const auto n = static_cast<std::uint64_t>(fitness_.size());
  if (!wheel_.empty()) {
    const auto at = std::upper_bound(wheel_.begin(), wheel_.end(), rng.uniform() * wheel_.back());
    return std::min<Index>(at - wheel_.begin(), fitness_.size() - 1);
  }
  auto winner = static_cast<Index>(rng.below(n));
  for (int round = 1; round < tournament_; ++round) {
    const auto rival = static_cast<Index>(rng.below(n));
    if (fitness_(rival) < fitness_(winner)) winner = rival;
  }
  return winner;
}

}  // namespace vernier
