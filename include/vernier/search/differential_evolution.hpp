// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Differential evolution in its two classical forms.

#include <cstdint>

#include "vernier/search/bounds.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// What a difference is added to.
enum class DifferentialBase {
  random,  ///< DE/rand/1: another individual drawn at random
  best,    ///< DE/best/1: the best so far
};

/// Differential evolution, DE/rand/1/bin or DE/best/1/bin: every individual is the target of a trial,
/// `base + weight (x_r2 - x_r3)`, crossed with it binomially, and is replaced by a trial that is not worse. All trials
/// of a generation are made, then evaluated; nothing outside the box is evaluated.
/// @cite Storn and Price 1997; Zhang and Sanderson 2009
struct DifferentialEvolution {
  int individuals = 50;                ///< at least 4
  Index generations = 300;             ///< after the first population
  double weight = 0.5;                 ///< F, of the difference
  double crossover_probability = 0.9;  ///< CR, per variable
  /// What the difference is added to.
  DifferentialBase base = DifferentialBase::random;
  /// What happens to coordinates outside the box.
  TrialRule trials_outside = TrialRule::halfway;

  /// A population between two generations.
  struct State : PointPopulation {
    /// Whether the sizes of the members agree.
    bool consistent() const { return PointPopulation::consistent(4); }
  };

  /// Individuals uniform in the box.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// One trial per individual.
  Index next_evaluations(const State& s) const { return s.positions.cols(); }

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/differential_evolution.ipp"
#endif
