#pragma once

/// @file
/// A binary-coded genetic algorithm.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vernier/core/rng.hpp"
#include "vernier/search/concepts.hpp"

namespace vernier {

/// Genetic algorithm with the paper's constants. The paper states neither encoding nor selection; ours are the
/// classical ones:
///
/// - encoding: each variable is `bits` bits of plain binary over its interval, so nothing outside the box can be
/// expressed;
/// - selection: tournaments of `tournament` individuals;
/// - crossover: with `crossover_probability` a pair exchanges all bits behind one cut, anywhere in the chromosome;
/// - mutation: each *bit* flips with `mutation_probability`: at 0.01 and 10 bits, about a tenth of the variables of a
/// child change;
/// - elitism: the `elites` best survive unchanged (and are not evaluated again).
/// @cite Holland 1975; Goldberg 1989
struct GeneticAlgorithm {
  int individuals = 80;                ///< at least 2
  Index generations = 400;             ///< after the first population
  double crossover_probability = 0.6;  ///< per pair
  double mutation_probability = 0.01;  ///< per bit
  int bits = 10;                       ///< per variable, 1 to 16
  int tournament = 2;                  ///< 1 selects at random
  int elites = 1;                      ///< below `individuals`

  /// Binary codes, one variable a number.
  using Codes = Eigen::Matrix<std::uint16_t, Eigen::Dynamic, Eigen::Dynamic>;

  /// A population between two generations.
  struct State {
    Codes codes;      ///< dimension x individuals
    VectorX fitness;  ///< one value an individual
    /// Best point of all.
    VectorX best;
    /// Its value.
    double best_fitness = 0;
    /// Generations stepped.
    Index generation = 0;
    /// Source of all randomness.
    Rng rng;
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
    Index leader = 0;
    s.best_fitness = s.fitness.minCoeff(&leader);
    s.best = points.col(leader);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const Index n = s.codes.cols(), children = n - elites;
    Codes next(s.codes.rows(), children);
    for (Index k = 0; k < children; k += 2) {
      next.col(k) = s.codes.col(select(s));
      if (k + 1 == children) break;
      next.col(k + 1) = s.codes.col(select(s));
      if (s.rng.uniform() < crossover_probability)
        cross(next, k,
              static_cast<Index>(
                  s.rng.below(static_cast<std::uint64_t>(next.rows()) * static_cast<std::uint64_t>(bits))));
    }
    mutate(next, s.rng);

    const MatrixX points = decode(next, box);
    VectorX fitness;
    evaluate(points, fitness);
    std::vector<Index> order(static_cast<std::size_t>(n));
    for (Index k = 0; k < n; ++k) order[static_cast<std::size_t>(k)] = k;
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return s.fitness(a) != s.fitness(b) ? s.fitness(a) < s.fitness(b) : a < b; });
    Codes survivors(s.codes.rows(), n);
    VectorX values(n);
    for (Index k = 0; k < elites; ++k) {
      survivors.col(k) = s.codes.col(order[static_cast<std::size_t>(k)]);
      values(k) = s.fitness(order[static_cast<std::size_t>(k)]);
    }
    survivors.rightCols(children) = next;
    values.tail(children) = fitness;
    s.codes.swap(survivors);
    s.fitness.swap(values);
    Index leader = 0;
    if (const double best = fitness.minCoeff(&leader); best < s.best_fitness) {
      s.best_fitness = best;
      s.best = points.col(leader);
    }
    ++s.generation;
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
    std::uint16_t& a = codes(variable, k);
    std::uint16_t& b = codes(variable, k + 1);
    const auto differing = static_cast<std::uint16_t>((a ^ b) & low);
    a = static_cast<std::uint16_t>(a ^ differing);
    b = static_cast<std::uint16_t>(b ^ differing);
    const Index rest = codes.rows() - variable - 1;
    codes.col(k).tail(rest).swap(codes.col(k + 1).tail(rest));
  }

 private:
  Index select(State& s) const {
    Index winner = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(s.codes.cols())));
    for (int round = 1; round < tournament; ++round) {
      const auto rival = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(s.codes.cols())));
      if (s.fitness(rival) < s.fitness(winner)) winner = rival;
    }
    return winner;
  }

  /// Flips each bit with the mutation probability, by jumping from flip to flip (geometric gaps).
  void mutate(Codes& codes, Rng& rng) const {
    if (mutation_probability <= 0) return;
    const double total = static_cast<double>(codes.size()) * bits;
    const double log_stay = std::log1p(-std::min(mutation_probability, 1 - 1e-12));
    for (double at = -1;;) {
      at += 1 + std::floor(std::log1p(-rng.uniform()) / log_stay);
      if (!(at < total)) return;
      const auto bit = static_cast<Index>(at);
      codes.data()[bit / bits] ^= static_cast<std::uint16_t>(1u << (bit % bits));
    }
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
