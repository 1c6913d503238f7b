// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/genetic_algorithm.hpp"

#include <algorithm>
#include <utility>

#include "vernier/search/detail/genetic_operators.hpp"

namespace vernier {

namespace detail {

/// Exchanges the bits of a mask.
VERNIER_LOCAL inline void exchange_bits(std::uint16_t& a, std::uint16_t& b, std::uint16_t mask) {
  const auto differing = static_cast<std::uint16_t>((a ^ b) & mask);
  a = static_cast<std::uint16_t>(a ^ differing);
  b = static_cast<std::uint16_t>(b ^ differing);
}

}  // namespace detail

VERNIER_IMPL GeneticAlgorithm::State GeneticAlgorithm::start(const Box& box, std::uint64_t seed,
                                                             Evaluate evaluate) const {
  validate();
  State s;
  s.rng = Rng(seed);
  s.codes.resize(box.dimension(), individuals);
  for (Index i = 0; i < s.codes.size(); ++i)
    s.codes.data()[i] = static_cast<std::uint16_t>(s.rng.below(std::uint64_t{1} << bits));
  const MatrixX points = decode(s.codes, box);
  evaluate(points, s.fitness);
  s.keep_best(points, s.fitness);
  return s;
}

VERNIER_IMPL void GeneticAlgorithm::step(State& s, const Box& box, Evaluate evaluate) const {
  const auto crossed = [&](Codes& children, Index k) {
    if (crossover == BitCrossover::one_point) {
      cross(children, k,
            static_cast<Index>(
                s.rng.below(static_cast<std::uint64_t>(children.rows()) * static_cast<std::uint64_t>(bits))));
    } else {
      for (Index d = 0; d < children.rows(); ++d)
        detail::exchange_bits(children(d, k), children(d, k + 1), static_cast<std::uint16_t>(s.rng() >> (64 - bits)));
    }
  };
  const auto mutated = [&](Codes& children) {
    detail::for_each_hit(static_cast<double>(children.size()) * bits, mutation_probability, s.rng, [&](Index bit) {
      children.data()[bit / bits] ^= static_cast<std::uint16_t>(1u << (bit % bits));
    });
  };
  detail::next_generation(
      *this, s, s.codes, crossed, mutated, [&](const Codes& codes) { return decode(codes, box); }, evaluate);
}

VERNIER_IMPL MatrixX GeneticAlgorithm::decode(const Codes& codes, const Box& box) const {
  const double steps = static_cast<double>((1u << bits) - 1);
  MatrixX points(codes.rows(), codes.cols());
  for (Index k = 0; k < points.cols(); ++k)
    for (Index d = 0; d < points.rows(); ++d) {
      const double lower = box.lower(d), upper = box.upper(d);
      points(d, k) = std::clamp((upper - lower) * (codes(d, k) / steps) + lower, lower, upper);
    }
  return points;
}

VERNIER_IMPL void GeneticAlgorithm::cross(Codes& codes, Index k, Index cut) const {
  const Index variable = cut / bits;
  const auto low = static_cast<std::uint16_t>((1u << (bits - static_cast<int>(cut % bits))) - 1);
  detail::exchange_bits(codes(variable, k), codes(variable, k + 1), low);
  for (Index d = variable + 1; d < codes.rows(); ++d) std::swap(codes(d, k), codes(d, k + 1));
}

VERNIER_IMPL void GeneticAlgorithm::validate() const {
  demand(individuals >= 2, "GeneticAlgorithm: individuals is ", individuals, ", must be at least 2");
  demand(generations >= 0, "GeneticAlgorithm: generations is ", generations, ", must not be negative");
  demand(bits >= 1 && bits <= 16, "GeneticAlgorithm: bits is ", bits, ", must lie in 1..16");
  demand(tournament >= 1, "GeneticAlgorithm: tournament is ", tournament, ", must be at least 1");
  demand(elites >= 0 && elites < individuals, "GeneticAlgorithm: elites is ", elites, ", must lie in 0..individuals-1");
  demand(crossover_probability >= 0 && crossover_probability <= 1, "GeneticAlgorithm: crossover_probability is ",
         crossover_probability, ", must lie in [0, 1]");
  demand(mutation_probability >= 0 && mutation_probability <= 1, "GeneticAlgorithm: mutation_probability is ",
         mutation_probability, ", must lie in [0, 1]");
}

}  // namespace vernier
