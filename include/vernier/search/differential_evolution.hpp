#pragma once

/// @file
/// Differential evolution in its two classical forms.

#include <cstdint>

#include "vernier/search/bounds.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// An index below n that differs from all others given.
template <class... Others>
Index index_besides(Index n, Rng& rng, Others... others) {
  for (;;)
    if (const auto i = static_cast<Index>(rng.below(static_cast<std::uint64_t>(n))); ((i != others) && ...)) return i;
}

/// What becomes of a trial's coordinate that leaves the box.
enum class TrialRule {
  halfway,  ///< put halfway between the individual it challenges and the bound
  redrawn,  ///< drawn anew, uniformly: keeps populations apart that would close in too early
};

/// Binomial crossover: `trial` takes `mutant(d)` in one dimension drawn at random and in each other one with
/// probability `rate`, otherwise it keeps the parent's.
template <class Parent, class Mutant, class Trial>
void cross_binomially(const Parent& parent, Mutant&& mutant, double rate, TrialRule rule, const Box& box, Rng& rng,
                      Trial&& trial) {
  const auto certain = static_cast<Index>(rng.below(static_cast<std::uint64_t>(parent.size())));
  for (Index d = 0; d < parent.size(); ++d) {
    const double lower = box.lower(d), upper = box.upper(d);
    double x = parent(d);
    if (rng.uniform() < rate || d == certain) x = mutant(d);
    if (x < lower || x > upper)
      x = rule == TrialRule::halfway ? halfway(x, parent(d), lower, upper) : rng.uniform(lower, upper);
    trial(d) = x;
  }
}

/// What a difference is added to.
enum class DifferentialBase {
  random,  ///< DE/rand/1: another individual drawn at random
  best,    ///< DE/best/1: the best so far
};

/// Differential evolution, DE/rand/1/bin or DE/best/1/bin: every individual is challenged by
/// `base + weight (x_r2 - x_r3)`, crossed with it binomially, and gives way to a trial that is not worse. All trials of
/// a generation are made, then evaluated; nothing outside the box is.
/// @cite Storn and Price 1997; Zhang and Sanderson 2009
struct DifferentialEvolution {
  int individuals = 50;                ///< at least 4
  Index generations = 300;             ///< after the first population
  double weight = 0.5;                 ///< F, of the difference
  double crossover_probability = 0.9;  ///< CR, per variable
  /// What the difference is added to.
  DifferentialBase base = DifferentialBase::random;
  /// What becomes of coordinates outside the box.
  TrialRule trials_outside = TrialRule::halfway;

  /// A population between two generations.
  struct State : PointPopulation {
    /// Whether the sizes of the members agree.
    bool consistent() const { return PointPopulation::consistent(4); }
  };

  /// Individuals uniform in the box.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.draw(box, individuals, seed, evaluate);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const MatrixX& x = s.positions;
    const Index n = x.cols();
    MatrixX trials(x.rows(), n);
    for (Index k = 0; k < n; ++k) {
      const Index r1 = index_besides(n, s.rng, k), r2 = index_besides(n, s.rng, k, r1),
                  r3 = index_besides(n, s.rng, k, r1, r2);
      const double* from = base == DifferentialBase::best ? s.best.data() : x.col(r1).data();
      cross_binomially(
          x.col(k), [&](Index d) { return from[d] + weight * (x(d, r2) - x(d, r3)); }, crossover_probability,
          trials_outside, box, s.rng, trials.col(k));
    }
    VectorX values;
    evaluate(trials, values);
    for (Index k = 0; k < n; ++k) {
      if (values(k) > s.fitness(k)) continue;
      s.positions.col(k) = trials.col(k);
      s.fitness(k) = values(k);
    }
    s.keep_best(trials, values);
    ++s.generation;
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

 private:
  void validate() const {
    require(individuals >= 4, "DifferentialEvolution: individuals is ", individuals, ", must be at least 4");
    require(generations >= 0, "DifferentialEvolution: generations is ", generations, ", must not be negative");
    require(weight > 0 && weight <= 10, "DifferentialEvolution: weight is ", weight, ", must lie in (0, 10]");
    require(crossover_probability >= 0 && crossover_probability <= 1,
            "DifferentialEvolution: crossover_probability is ", crossover_probability, ", must lie in [0, 1]");
  }
};

}  // namespace vernier
