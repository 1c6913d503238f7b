// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A binary-coded genetic algorithm.

#include <cstdint>

#include "vernier/search/parent_selection.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// How two chromosomes are crossed.
enum class BitCrossover {
  one_point,  ///< all bits behind one cut are exchanged
  uniform,    ///< each bit is exchanged with probability 1/2
};

/// Genetic algorithm with the paper's constants. The paper states neither encoding nor selection; these are the
/// classical ones:
///
/// - encoding: each variable has `bits` bits of plain binary code over its interval, so no code lies outside the box;
/// - selection: tournaments of `tournament` individuals, or roulette;
/// - crossover: with `crossover_probability` a pair exchanges all bits behind one cut, anywhere in the chromosome; or,
/// uniform, each bit with probability 1/2;
/// - mutation: each *bit* flips with `mutation_probability`: at 0.01 and 10 bits, about a tenth of the variables of a
///   child change;
/// - elitism: the `elites` best survive unchanged (and are not evaluated again).
/// @cite Holland 1975; Goldberg 1989; Syswerda 1989
struct GeneticAlgorithm {
  int individuals = 80;                ///< at least 2
  Index generations = 400;             ///< after the first population
  double crossover_probability = 0.6;  ///< per pair
  double mutation_probability = 0.01;  ///< per bit
  int bits = 10;                       ///< per variable, 1 to 16
  int tournament = 2;                  ///< 1 selects at random
  int elites = 1;                      ///< below `individuals`
  /// How pairs are crossed.
  BitCrossover crossover = BitCrossover::one_point;
  /// How parents are selected.
  ParentSelection selection = ParentSelection::tournament;

  /// Binary codes, one number per variable.
  using Codes = Eigen::Matrix<std::uint16_t, Eigen::Dynamic, Eigen::Dynamic>;

  /// A population between two generations.
  struct State : CommonState {
    Codes codes;      ///< dimension x individuals
    VectorX fitness;  ///< one value per individual

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      CommonState::each_member(s, visit);
      visit("codes", s.codes);
      visit("fitness", s.fitness);
    }

    /// Whether the sizes of the members agree.
    bool consistent() const {
      return codes.cols() >= 2 && codes.rows() == best.size() && fitness.size() == codes.cols();
    }
  };

  /// Every bit drawn at random.
  VERNIER_API State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const;

  /// One generation.
  VERNIER_API void step(State& s, const Box& box, Evaluate evaluate) const;

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// All individuals but the elites.
  Index next_evaluations(const State& s) const { return s.codes.cols() - elites; }

  /// The points that codes stand for: 0 is the lower bound, all ones the upper.
  VERNIER_API MatrixX decode(const Codes& codes, const Box& box) const;

  /// Exchanges the bits behind position `cut` between columns k and k + 1; a chromosome counts bits from the most
  /// significant of variable 0.
  VERNIER_API void cross(Codes& codes, Index k, Index cut) const;

 private:
  VERNIER_API void validate() const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/search/genetic_algorithm.ipp"
#endif
