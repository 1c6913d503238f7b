// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A genetic algorithm on real numbers.

#include <cstdint>
#include <utility>

#include "vernier/search/parent_selection.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// How two real-coded individuals are crossed.
enum class RealCrossover {
  sbx,        ///< simulated binary crossover within the bounds, each variable with probability 1/2
  blx,        ///< BLX-alpha: each variable of both children uniform in the parents' interval, widened by alpha of its
              ///< length on either side, within the bounds
  one_point,  ///< all variables behind one cut are exchanged
  uniform,    ///< each variable is exchanged with probability 1/2
};

/// How a real variable mutates.
enum class RealMutation {
  polynomial,  ///< Deb's polynomial distribution, truncated at the bounds
  gaussian,    ///< a normal step, reflected at the bounds
};

/// Which individuals survive a generation.
enum class Survival {
  elites,        ///< the elites and all children
  best_of_both,  ///< the best of parents and children, as many as there were
};

/// Real-coded genetic algorithm: pairs of parents are crossed with `crossover_probability`, each variable of a child
/// mutates with probability `mutations / dimension`, the best of parents and children survive, or the children and the
/// `elites` best (which are not evaluated again). Nothing outside the box is evaluated.
/// @cite Deb and Agrawal 1995; Eshelman and Schaffer 1993; Deb and Goyal 1996; Goldberg 1989
struct RealGeneticAlgorithm {
  int individuals = 80;                ///< at least 2
  Index generations = 400;             ///< after the first population
  double crossover_probability = 0.9;  ///< per pair
  double mutations = 1;                ///< expected number of mutated variables per child
  int tournament = 2;                  ///< 1 selects at random
  int elites = 1;                      ///< of `Survival::elites`, below `individuals`
  /// How pairs are crossed.
  RealCrossover crossover = RealCrossover::sbx;
  /// How variables mutate.
  RealMutation mutation = RealMutation::polynomial;
  /// How parents are selected.
  ParentSelection selection = ParentSelection::tournament;
  /// Which individuals survive.
  Survival survival = Survival::best_of_both;
  double crossover_index = 15;   ///< eta of SBX: the larger, the closer children are to their parents
  double mutation_index = 20;    ///< eta of the polynomial mutation
  double blend = 0.5;            ///< alpha of BLX
  double mutation_sigma = 0.05;  ///< of the gaussian mutation, relative to the width of the box

  /// A population between two generations.
  struct State : PointPopulation {
    /// Whether the sizes of the members agree.
    bool consistent() const { return PointPopulation::consistent(2); }
  };

  /// Individuals uniform in the box.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// All individuals, or all but the elites.
  Index next_evaluations(const State& s) const {
    return s.positions.cols() - (survival == Survival::elites ? elites : 0);
  }

  /// Crosses columns k and k + 1.
  VERNIER_API void cross(MatrixX& children, Index k, const Box& box, Rng& rng) const;

  /// The children of SBX at a uniform number u in [0, 1): each lies beta times half the distance of a and b from their
  /// mean, with its own beta, whose distribution is truncated at the bounds. The child on the lower side is the first.
  VERNIER_API std::pair<double, double> simulated_binary(double a, double b, double lower, double upper,
                                                         double u) const;

  /// Polynomial mutation of x at a uniform number u in [0, 1).
  VERNIER_API double polynomial(double x, double lower, double upper, double u) const;

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/real_genetic_algorithm.ipp"
#endif
