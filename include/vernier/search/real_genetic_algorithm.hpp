#pragma once

/// @file
/// A genetic algorithm on real numbers.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "vernier/search/bounds.hpp"
#include "vernier/search/genetic_operators.hpp"

namespace vernier {

/// How two real-coded individuals are crossed.
enum class RealCrossover {
  sbx,        ///< simulated binary crossover within the bounds, each variable with probability 1/2
  blx,        ///< BLX-alpha: each variable of both children uniform in the parents' interval, widened by alpha of its
              ///< length on either side, within the bounds
  one_point,  ///< all variables behind one cut change sides
  uniform,    ///< each variable changes sides with probability 1/2
};

/// How a real variable mutates.
enum class RealMutation {
  polynomial,  ///< Deb's polynomial distribution, which ends at the bounds
  gaussian,    ///< a normal step, mirrored at the bounds
};

/// Who lives on after a generation.
enum class Survival {
  elites,        ///< the elites and all children
  best_of_both,  ///< the best of parents and children, as many as there were
};

/// Real-coded genetic algorithm: pairs of parents are crossed with `crossover_probability`, each variable of a child
/// mutates with probability `mutations / dimension`, the best of parents and children live on, or the children and the
/// `elites` best (which are not evaluated again). Nothing outside the box is evaluated.
/// @cite Deb and Agrawal 1995; Eshelman and Schaffer 1993; Deb and Goyal 1996; Goldberg 1989
struct RealGeneticAlgorithm {
  int individuals = 80;                ///< at least 2
  Index generations = 400;             ///< after the first population
  double crossover_probability = 0.9;  ///< per pair
  double mutations = 1;                ///< expected number of variables that mutate in a child
  int tournament = 2;                  ///< 1 selects at random
  int elites = 1;                      ///< of `Survival::elites`, below `individuals`
  /// How pairs are crossed.
  RealCrossover crossover = RealCrossover::sbx;
  /// How variables mutate.
  RealMutation mutation = RealMutation::polynomial;
  /// How parents are chosen.
  ParentSelection selection = ParentSelection::tournament;
  /// Who lives on.
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
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.draw(box, individuals, seed, evaluate);
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const auto mutated = [&](MatrixX& children) {
      const Index n = children.rows();
      for_each_hit(static_cast<double>(children.size()), std::min(1.0, mutations / static_cast<double>(n)), s.rng,
                   [&](Index i) {
                     double& x = children.data()[i];
                     const double lower = box.lower(i % n), upper = box.upper(i % n);
                     x = mutation == RealMutation::polynomial
                             ? polynomial(x, lower, upper, s.rng.uniform())
                             : reflected(x + mutation_sigma * (upper - lower) * s.rng.normal(), lower, upper);
                   });
    };
    next_generation(
        *this, s, s.positions, [&](MatrixX& children, Index k) { cross(children, k, box, s.rng); }, mutated,
        [](const MatrixX& points) -> const MatrixX& { return points; }, evaluate, survival == Survival::best_of_both);
  }

  /// Whether all generations of the schedule were stepped.
  bool done(const State& s) const { return s.generation >= generations; }

  /// Crosses columns k and k + 1.
  void cross(MatrixX& children, Index k, const Box& box, Rng& rng) const {
    const Index n = children.rows();
    if (crossover == RealCrossover::one_point) {
      const Index rest = n - static_cast<Index>(rng.below(static_cast<std::uint64_t>(n)));
      children.col(k).tail(rest).swap(children.col(k + 1).tail(rest));
      return;
    }
    for (Index d = 0; d < n; ++d) {
      double& a = children(d, k);
      double& b = children(d, k + 1);
      if (crossover == RealCrossover::blx) {
        const double reach = blend * std::abs(b - a);
        const double lower = std::max(box.lower(d), std::min(a, b) - reach);
        const double upper = std::min(box.upper(d), std::max(a, b) + reach);
        for (double* x : {&a, &b}) *x = std::clamp(rng.uniform(lower, upper), lower, upper);
      } else if (rng.sign() > 0) {
        if (crossover == RealCrossover::sbx)
          std::tie(a, b) = simulated_binary(a, b, box.lower(d), box.upper(d), rng.uniform());
        if (crossover == RealCrossover::uniform || rng.sign() > 0) std::swap(a, b);
      }
    }
  }

  /// The children of SBX at a uniform number u in [0, 1): their distance is beta times that of a and b, each with a
  /// beta of its own, bent so that it stays within the bounds. The child on the lower side is the first.
  std::pair<double, double> simulated_binary(double a, double b, double lower, double upper, double u) const {
    const double low = std::min(a, b), high = std::max(a, b), distance = high - low;
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

  /// Polynomial mutation of x at a uniform number u in [0, 1).
  double polynomial(double x, double lower, double upper, double u) const {
    const double power = mutation_index + 1, width = upper - lower;
    const double step = u < 0.5
                            ? std::pow(2 * u + (1 - 2 * u) * std::pow((upper - x) / width, power), 1 / power) - 1
                            : 1 - std::pow(2 * (1 - u) + (2 * u - 1) * std::pow((x - lower) / width, power), 1 / power);
    return std::clamp(x + step * width, lower, upper);
  }

 private:
  void validate() const {
    require(individuals >= 2, "RealGeneticAlgorithm: individuals is ", individuals, ", must be at least 2");
    require(generations >= 0, "RealGeneticAlgorithm: generations is ", generations, ", must not be negative");
    require(tournament >= 1, "RealGeneticAlgorithm: tournament is ", tournament, ", must be at least 1");
    require(elites >= 0 && elites < individuals, "RealGeneticAlgorithm: elites is ", elites,
            ", must lie in 0..individuals-1");
    require(crossover_probability >= 0 && crossover_probability <= 1, "RealGeneticAlgorithm: crossover_probability is ",
            crossover_probability, ", must lie in [0, 1]");
    require(mutations >= 0, "RealGeneticAlgorithm: mutations is ", mutations, ", must not be negative");
    require(crossover_index >= 0 && crossover_index <= 1000 && mutation_index >= 0 && mutation_index <= 1000,
            "RealGeneticAlgorithm: crossover_index ", crossover_index, " and mutation_index ", mutation_index,
            " must lie in [0, 1000]");
    require(blend >= 0 && blend <= 10 && mutation_sigma > 0 && mutation_sigma <= 10, "RealGeneticAlgorithm: blend ",
            blend, " must lie in [0, 10] and mutation_sigma ", mutation_sigma, " in (0, 10]");
  }
};

}  // namespace vernier
