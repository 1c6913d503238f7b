#pragma once

/// @file
/// L-SHADE: differential evolution that learns its constants and shrinks its population.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "vernier/core/argsort.hpp"
#include "vernier/search/differential_evolution.hpp"

namespace vernier {

/// Differential evolution with success-history memory, an archive of the defeated and linear reduction of the
/// population, DE/current-to-pbest/1/bin:
///
/// - each trial draws its F from a Cauchy and its CR from a normal distribution about one of `memory` remembered pairs;
///   after a generation the oldest pair becomes the Lehmer means of what succeeded, weighted by the improvements;
/// - the difference's second individual may come from the archive of those that were beaten;
/// - the population falls linearly from `individuals_per_dimension` times the dimension to `final_individuals`, over
///   `max_evaluations`, of which the last generation makes no more than are left.
///
/// A coordinate that would leave the box is put halfway between the individual it challenges and the bound. An
/// improvement on an infinite value counts as the greatest finite one of its generation.
/// @cite Tanabe and Fukunaga 2014
struct LShade {
  Index max_evaluations = 15'000;         ///< the schedule, the first population included
  double individuals_per_dimension = 18;  ///< of the first population, which has at least `final_individuals`
  int final_individuals = 4;              ///< at least 4
  int memory = 6;                         ///< remembered pairs of F and CR
  double archive_rate = 2.6;              ///< size of the archive relative to the population
  double best_share = 0.11;               ///< p: the share of the population that counts as best, at least two

  /// A population between two generations.
  struct State : PointPopulation {
    MatrixX archive;          ///< dimension x beaten individuals
    VectorX weights;          ///< remembered F
    VectorX crossover_rates;  ///< remembered CR; negative: stays zero
    Index oldest = 0;         ///< the pair to be replaced next
    Index evaluations = 0;    ///< made so far
    Index first_size = 0;     ///< of the first population

    /// Lists the members.
    template <class Self, class Visit>
    static void each_member(Self& s, Visit&& visit) {
      PointPopulation::each_member(s, visit);
      visit("archive", s.archive);
      visit("weights", s.weights);
      visit("crossover_rates", s.crossover_rates);
      visit("oldest", s.oldest);
      visit("evaluations", s.evaluations);
      visit("first_size", s.first_size);
    }

    /// Whether the sizes of the members agree.
    bool consistent() const {
      return PointPopulation::consistent(4) && archive.rows() == best.size() && weights.size() >= 1 &&
             crossover_rates.size() == weights.size() && oldest >= 0 && oldest < weights.size();
    }
  };

  /// Individuals uniform in the box.
  State start(const Box& box, std::uint64_t seed, Evaluate evaluate) const {
    validate();
    State s;
    s.first_size = std::max<Index>(final_individuals,
                                   std::lround(individuals_per_dimension * static_cast<double>(box.dimension())));
    require(max_evaluations >= s.first_size, "LShade: max_evaluations is ", max_evaluations,
            ", less than the first population of ", s.first_size);
    s.draw(box, s.first_size, seed, evaluate);
    s.archive.resize(box.dimension(), 0);
    s.weights = s.crossover_rates = VectorX::Constant(memory, 0.5);
    s.evaluations = s.first_size;
    return s;
  }

  /// One generation.
  void step(State& s, const Box& box, Evaluate evaluate) const {
    const MatrixX& x = s.positions;
    const Index n = x.cols(), count = std::min(n, max_evaluations - s.evaluations);
    const auto order = argsort(s.fitness);
    const auto leaders = static_cast<std::uint64_t>(
        std::min<Index>(n, std::max<Index>(2, std::lround(best_share * static_cast<double>(n)))));
    MatrixX trials(x.rows(), count);
    VectorX f(count), cr(count), values;
    for (Index k = 0; k < count; ++k) {
      const auto pair = static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(s.weights.size())));
      const double rate = s.crossover_rates(pair);
      cr(k) = rate < 0 ? 0 : std::clamp(rate + 0.1 * s.rng.normal(), 0.0, 1.0);
      do {
        f(k) = std::min(1.0, s.weights(pair) + 0.1 * std::tan(std::numbers::pi * (s.rng.uniform() - 0.5)));
      } while (!(f(k) > 0));
      const Index leader = order[s.rng.below(leaders)], r1 = index_besides(n, s.rng, k),
                  r2 = index_besides(n + s.archive.cols(), s.rng, k, r1);
      const double* other = r2 < n ? x.col(r2).data() : s.archive.col(r2 - n).data();
      cross_binomially(
          x.col(k), [&](Index d) { return x(d, k) + f(k) * (x(d, leader) - x(d, k)) + f(k) * (x(d, r1) - other[d]); },
          cr(k), TrialRule::halfway, box, s.rng, trials.col(k));
    }
    evaluate(trials, values);
    s.evaluations += count;
    s.keep_best(trials, values);
    remember(s, values, f, cr);
    replace(s, trials, values);
    shrink(s);
    ++s.generation;
  }

  /// Whether all evaluations of the schedule were made.
  bool done(const State& s) const { return s.evaluations >= max_evaluations; }

  /// Individuals after so many evaluations.
  Index individuals(Index first, Index evaluations) const {
    const double share = static_cast<double>(evaluations) / static_cast<double>(max_evaluations);
    return std::lround(static_cast<double>(first) + (final_individuals - static_cast<double>(first)) * share);
  }

  /// Writes what succeeded over the oldest pair; nothing where nothing did.
  static void remember(State& s, const VectorX& values, const VectorX& f, const VectorX& cr) {
    double greatest = 0;  // finite improvement
    for (Index k = 0; k < values.size(); ++k)
      if (const double gain = s.fitness(k) - values(k); std::isfinite(gain)) greatest = std::max(greatest, gain);
    double f1 = 0, f2 = 0, cr1 = 0, cr2 = 0;
    bool any = false;
    for (Index k = 0; k < values.size(); ++k) {
      if (!(values(k) < s.fitness(k))) continue;
      any = true;
      const double gain = s.fitness(k) - values(k), w = std::isfinite(gain) ? gain : greatest > 0 ? greatest : 1;
      f1 += w * f(k);
      f2 += w * f(k) * f(k);
      cr1 += w * cr(k);
      cr2 += w * cr(k) * cr(k);
    }
    if (!any) return;
    double& rate = s.crossover_rates(s.oldest);
    rate = rate < 0 || !(cr1 > 0) ? -1 : cr2 / cr1;
    if (f1 > 0) s.weights(s.oldest) = f2 / f1;
    s.oldest = (s.oldest + 1) % s.weights.size();
  }

 private:
  Index archive_size(Index individuals) const { return std::lround(archive_rate * static_cast<double>(individuals)); }

  /// Trials that are not worse take their places; whom they bettered goes to the archive, at random places once it is
  /// full.
  void replace(State& s, const MatrixX& trials, const VectorX& values) const {
    const Index full = archive_size(s.positions.cols());
    MatrixX archive(s.archive.rows(), std::max(full, s.archive.cols()));
    Index held = s.archive.cols();
    archive.leftCols(held) = s.archive;
    for (Index k = 0; k < values.size(); ++k) {
      if (values(k) > s.fitness(k)) continue;
      if (values(k) < s.fitness(k) && full > 0) {
        const Index at = held < full ? held++ : static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(held)));
        archive.col(at) = s.positions.col(k);
      }
      s.positions.col(k) = trials.col(k);
      s.fitness(k) = values(k);
    }
    s.archive = archive.leftCols(held);
  }

  /// Drops the worst, and as much of the archive as no longer fits, at random.
  void shrink(State& s) const {
    const Index n = std::max<Index>(final_individuals, individuals(s.first_size, s.evaluations));
    if (n >= s.positions.cols()) return;
    const auto order = argsort(s.fitness);
    MatrixX positions(s.positions.rows(), n);
    VectorX fitness(n);
    for (Index k = 0; k < n; ++k) {
      positions.col(k) = s.positions.col(order[static_cast<std::size_t>(k)]);
      fitness(k) = s.fitness(order[static_cast<std::size_t>(k)]);
    }
    s.positions.swap(positions);
    s.fitness.swap(fitness);
    Index held = s.archive.cols();
    for (; held > archive_size(n); --held)
      s.archive.col(static_cast<Index>(s.rng.below(static_cast<std::uint64_t>(held)))) = s.archive.col(held - 1).eval();
    s.archive.conservativeResize(Eigen::NoChange, held);
  }

  void validate() const {
    require(individuals_per_dimension > 0 && individuals_per_dimension <= 1e6, "LShade: individuals_per_dimension is ",
            individuals_per_dimension, ", must lie in (0, 1e6]");
    require(final_individuals >= 4, "LShade: final_individuals is ", final_individuals, ", must be at least 4");
    require(memory >= 1, "LShade: memory is ", memory, ", must be at least 1");
    require(archive_rate >= 0 && archive_rate <= 1000, "LShade: archive_rate is ", archive_rate,
            ", must lie in [0, 1000]");
    require(best_share >= 0 && best_share <= 1, "LShade: best_share is ", best_share, ", must lie in [0, 1]");
  }
};

}  // namespace vernier
