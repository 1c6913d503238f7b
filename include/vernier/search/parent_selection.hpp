// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Selection of parents in genetic algorithms.

#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// How parents are selected.
enum class ParentSelection {
  tournament,  ///< the best of a few drawn at random, with repeats
  roulette,    ///< with a probability proportional to how far an individual's value lies below the worst finite one;
               ///< uniformly where all are equal
};

/// Selects parents from a population.
class ParentSelector {
 public:
  /// @param selection  how
  /// @param tournament number of candidates drawn
  /// @param fitness    values of the population; must outlive this
  VERNIER_API ParentSelector(ParentSelection selection, int tournament, const VectorX& fitness);

  /// Index of one parent.
  VERNIER_API Index operator()(Rng& rng) const;

 private:
  const VectorX& fitness_;
  int tournament_;
  std::vector<double> wheel_;  ///< cumulated weights
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/parent_selection.ipp"
#endif
