// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Random search: the baseline every search has to improve on.

#include "vernier/search/state.hpp"

namespace vernier {

/// Draws points uniformly from the box and keeps the best.
struct RandomSearch {
  int individuals = 50;     ///< points per generation, at least 1
  Index generations = 300;  ///< after the first population

  /// Between two generations.
  struct State : CommonState {
    /// Always: there are no members of its own.
    bool consistent() const { return true; }
  };

  /// The first points.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// As many new points.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// Points per generation.
  Index next_evaluations(const State&) const { return individuals; }
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/random_search.ipp"
#endif
