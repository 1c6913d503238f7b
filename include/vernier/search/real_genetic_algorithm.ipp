// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/search/real_genetic_algorithm.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "vernier/search/bounds.hpp"
#include "vernier/search/detail/genetic_operators.hpp"

namespace vernier {

VERNIER_IMPL RealGeneticAlgorithm::State RealGeneticAlgorithm::start(const Box& box, std::uint64_t seed,
                                                                     Evaluate evaluate) const {
  validate();
  State s;
  s.initialise(box, individuals, seed, evaluate);
  return s;
}

VERNIER_IMPL void RealGeneticAlgorithm::step(State& s, const Box& box, Evaluate evaluate) const {
  const auto mutated = [&](MatrixX& children) {
    const Index n = children.rows();
    detail::for_each_hit(static_cast<double>(children.size()), (std::min)(1.0, mutations / static_cast<double>(n)),
                         s.rng, [&](Index i) {
                           double& x = children.data()[i];
                           const double lower = box.lower(i % n), upper = box.upper(i % n);
                           x = mutation == RealMutation::polynomial
                                   ? polynomial(x, lower, upper, s.rng.uniform())
                                   : reflected(x + mutation_sigma * (upper - lower) * s.rng.normal(), lower, upper);
                         });
  };
  detail::next_generation(
      *this, s, s.positions, [&](MatrixX& children, Index k) { cross(children, k, box, s.rng); }, mutated,
      [](const MatrixX& points) -> const MatrixX& { return points; }, evaluate, survival == Survival::best_of_both);
}

VERNIER_IMPL void RealGeneticAlgorithm::cross(MatrixX& children, Index k, const Box& box, Rng& rng) const {
  const Index n = children.rows();
  if (crossover == RealCrossover::one_point) {
    const auto first = static_cast<Index>(rng.below(static_cast<std::uint64_t>(n)));
    for (Index d = first; d < n; ++d) std::swap(children(d, k), children(d, k + 1));
    return;
  }
  for (Index d = 0; d < n; ++d) {
    double& a = children(d, k);
    double& b = children(d, k + 1);
    if (crossover == RealCrossover::blx) {
      const double reach = blend * std::abs(b - a);
      const double lower = (std::max)(box.lower(d), (std::min)(a, b) - reach);
      const double upper = (std::min)(box.upper(d), (std::max)(a, b) + reach);
      for (double* x : {&a, &b}) *x = std::clamp(rng.uniform(lower, upper), lower, upper);
    } else if (rng.sign() > 0) {
      if (crossover == RealCrossover::sbx)
        std::tie(a, b) = simulated_binary(a, b, box.lower(d), box.upper(d), rng.uniform());
      if (crossover == RealCrossover::uniform || rng.sign() > 0) std::swap(a, b);
    }
  }
}

VERNIER_IMPL std::pair<double, double> RealGeneticAlgorithm::simulated_binary(double a, double b, double lower,
                                                                              double upper, double u) const {
  const double low = (std::min)(a, b), high = (std::max)(a, b), distance = high - low;
  if (!(distance > 1e-14 * (upper - lower))) return {low, high};
  const double power = 1 / (crossover_index + 1);
  const auto spread = [&](double room) {
    const double all = 2 - std::pow(1 + 2 * room / distance, -(crossover_index + 1));
    return u * all <= 1 ? std::pow(u * all, power) : std::pow(1 / (2 - u * all), power);
  };
  const double middle = (low + high) / 2;
  return {std::clamp(middle - spread(low - lower) * distance / 2, lower, upper),
          std::clamp(middle + spread(upper - high) * distance / 2, lower, upper)};
}

VERNIER_IMPL double RealGeneticAlgorithm::polynomial(double x, double lower, double upper, double u) const {
  const double power = mutation_index + 1, width = upper - lower;
  const double step = u < 0.5
                          ? std::pow(2 * u + (1 - 2 * u) * std::pow((upper - x) / width, power), 1 / power) - 1
                          : 1 - std::pow(2 * (1 - u) + (2 * u - 1) * std::pow((x - lower) / width, power), 1 / power);
  return std::clamp(x + step * width, lower, upper);
}

VERNIER_IMPL void RealGeneticAlgorithm::validate() const {
  demand(individuals >= 2, "RealGeneticAlgorithm: individuals is ", individuals, ", must be at least 2");
  demand(generations >= 0, "RealGeneticAlgorithm: generations is ", generations, ", must not be negative");
  demand(tournament >= 1, "RealGeneticAlgorithm: tournament is ", tournament, ", must be at least 1");
  demand(elites >= 0 && elites < individuals, "RealGeneticAlgorithm: elites is ", elites,
         ", must lie in 0..individuals-1");
  demand(crossover_probability >= 0 && crossover_probability <= 1, "RealGeneticAlgorithm: crossover_probability is ",
         crossover_probability, ", must lie in [0, 1]");
  demand(mutations >= 0, "RealGeneticAlgorithm: mutations is ", mutations, ", must not be negative");
  demand(crossover_index >= 0 && crossover_index <= 1000 && mutation_index >= 0 && mutation_index <= 1000,
         "RealGeneticAlgorithm: crossover_index ", crossover_index, " and mutation_index ", mutation_index,
         " must lie in [0, 1000]");
  demand(blend >= 0 && blend <= 10 && mutation_sigma > 0 && mutation_sigma <= 10, "RealGeneticAlgorithm: blend ", blend,
         " must lie in [0, 10] and mutation_sigma ", mutation_sigma, " in (0, 10]");
}

}  // namespace vernier
