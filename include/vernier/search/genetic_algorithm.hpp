#pragma once

/// @file
/// A binary-coded genetic algorithm.

#include <cstdint>

#include "vernier/search/genetic_operators.hpp"

namespace vernier {

/// How two chromosomes are crossed.
enum class BitCrossover {
  one_point,  ///< all bits behind one cut change sides
  uniform,    ///< each bit changes sides with probability 1/2
};

/// Genetic algorithm with the paper's constants. The paper states neither encoding nor selection; ours are the
/// classical ones:
///
/// - encoding: each variable is `bits` bits of plain binary over its interval, so nothing outside the box can be
/// expressed;
/// - selection: tournaments of `tournament` individuals, or roulette;
/// - crossover: with `crossover_probability` a pair exchanges all bits behind one cut, anywhere in the chromosome; or,
/// uniform, each bit with probability 1/2;
/// - mutation: each *bit* flips with `mutation_probability`: at 0.01 and 10 bits, about a tenth of the variables of a
/// child change;
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
  /// How parents are chosen.
  ParentSelection selection = ParentSelection::tournament;

  /// Binary codes, one variable a number.
  using Codes = Eigen::Matrix<std::uint16_t, Eigen::Dynamic, Eigen::Dynamic>;

  /// A population between two generations.
  struct State : CommonState {
    Codes codes;      ///< dimension x individuals
    VectorX fitness;  ///< one value an individual

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
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.rng = Rng(seed);
    s.codes.resize(box.dimension(), individuals);
    for (auto& code : s.codes.reshaped()) code = static_cast<std::uint16_t>(s.rng.below(std::uint64_t{1} << bits));
    const MatrixX points = decode(s.codes, box);
    evaluate(points, s.fitness);
    s.keep_best(points, s.fitness);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const auto crossed = [&](Codes& children, Index k) {
      if (crossover == BitCrossover::one_point) {
        cross(children, k,
              static_cast<Index>(
                  s.rng.below(static_cast<std::uint64_t>(children.rows()) * static_cast<std::uint64_t>(bits))));
      } else {
        for (Index d = 0; d < children.rows(); ++d)
          exchange(children(d, k), children(d, k + 1), static_cast<std::uint16_t>(s.rng() >> (64 - bits)));
      }
    };
    const auto mutated = [&](Codes& children) {
      for_each_hit(static_cast<double>(children.size()) * bits, mutation_probability, s.rng,
                   [&](Index bit) { children.data()[bit / bits] ^= static_cast<std::uint16_t>(1u << (bit % bits)); });
    };
    next_generation(
        *this, s, s.codes, crossed, mutated, [&](const Codes& codes) { return decode(codes, box); }, evaluate);
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// Values of codes: 0 is the lower bound, all ones the upper.
  MatrixX decode(const Codes& codes, const Box& box) const {
    const double steps = static_cast<double>((1u << bits) - 1);
    MatrixX out = codes.cast<double>() / steps;
    out = ((box.upper - box.lower).asDiagonal() * out).colwise() + box.lower;
    return out.cwiseMax(box.lower.replicate(1, out.cols())).cwiseMin(box.upper.replicate(1, out.cols()));
  }

  /// Exchanges the bits behind position `cut` between columns k and k + 1; a chromosome counts bits from the highest of
  /// variable 0.
  void cross(Codes& codes, Index k, Index cut) const {
    const Index variable = cut / bits;
    const auto low = static_cast<std::uint16_t>((1u << (bits - static_cast<int>(cut % bits))) - 1);
    exchange(codes(variable, k), codes(variable, k + 1), low);
    const Index rest = codes.rows() - variable - 1;
    codes.col(k).tail(rest).swap(codes.col(k + 1).tail(rest));
  }

 private:
  /// Exchanges the bits of a mask.
  static void exchange(std::uint16_t& a, std::uint16_t& b, std::uint16_t mask) {
    const auto differing = static_cast<std::uint16_t>((a ^ b) & mask);
    a = static_cast<std::uint16_t>(a ^ differing);
    b = static_cast<std::uint16_t>(b ^ differing);
  }

  void validate() const {
    require(individuals >= 2, "GeneticAlgorithm: individuals is ", individuals, ", must be at least 2");
    require(generations >= 0, "GeneticAlgorithm: generations is ", generations, ", must not be negative");
    require(bits >= 1 && bits <= 16, "GeneticAlgorithm: bits is ", bits, ", must lie in 1..16");
    require(tournament >= 1, "GeneticAlgorithm: tournament is ", tournament, ", must be at least 1");
    require(elites >= 0 && elites < individuals, "GeneticAlgorithm: elites is ", elites,
            ", must lie in 0..individuals-1");
    require(crossover_probability >= 0 && crossover_probability <= 1, "GeneticAlgorithm: crossover_probability is ",
            crossover_probability, ", must lie in [0, 1]");
    require(mutation_probability >= 0 && mutation_probability <= 1, "GeneticAlgorithm: mutation_probability is ",
            mutation_probability, ", must lie in [0, 1]");
  }
};

}  // namespace vernier
