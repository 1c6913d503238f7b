// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Mutation and crossover of differential evolution.

#include <algorithm>
#include <initializer_list>

#include "vernier/core/box.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/search/bounds.hpp"

namespace vernier::detail {

/// An index below n that differs from all others given, drawn uniformly.
VERNIER_API inline Index index_besides(Index n, std::initializer_list<Index> others, Rng& rng) {
  for (;;) {
    const auto i = static_cast<Index>(rng.below(static_cast<std::uint64_t>(n)));
    if (std::find(others.begin(), others.end(), i) == others.end()) return i;
  }
}

/// Binomial crossover: a coordinate of the trial is `mutant(d)` in one dimension drawn at random and in each other one
/// with probability `rate`, otherwise the target's.
template <class Mutant>
void cross_binomially(const double* target, const Mutant& mutant, double rate, TrialRule rule, const Box& box, Rng& rng,
                      double* trial) {
  const Index n = box.dimension(), certain = static_cast<Index>(rng.below(static_cast<std::uint64_t>(n)));
  for (Index d = 0; d < n; ++d) {
    const double lower = box.lower(d), upper = box.upper(d);
    double x = target[d];
    if (rng.uniform() < rate || d == certain) x = mutant(d);
    if (x < lower || x > upper)
      x = rule == TrialRule::halfway ? halfway(x, target[d], lower, upper) : rng.uniform(lower, upper);
    trial[d] = x;
  }
}

}  // namespace vernier::detail
