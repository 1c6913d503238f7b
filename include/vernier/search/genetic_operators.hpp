#pragma once

/// @file
/// What genetic algorithms share, whatever their genes: who becomes a parent, where mutations fall, who survives.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "vernier/core/argsort.hpp"
#include "vernier/search/state.hpp"

namespace vernier {

/// How parents are chosen.
enum class ParentSelection {
  tournament,  ///< the best of a few drawn at random, with repeats
  roulette,    ///< in proportion to how far an individual's value lies below the worst finite one; at random where none
               ///< does
};

/// Chooses parents from a population.
class ParentChoice {
 public:
  /// @param selection  how
  /// @param tournament how many are drawn
  /// @param fitness    values of the population; must outlive this
  ParentChoice(ParentSelection selection, int tournament, const VectorX& fitness)
      : fitness_(fitness), tournament_(tournament) {
    if (selection != ParentSelection::roulette) return;
    double worst = -std::numeric_limits<double>::infinity();
    for (const double value : fitness)
      if (std::isfinite(value)) worst = std::max(worst, value);
    double sum = 0;
    for (const double value : fitness) wheel_.push_back(sum += std::isfinite(value) ? worst - value : 0);
    if (!(sum > 0 && std::isfinite(sum))) {
      wheel_.clear();
      tournament_ = 1;
    }
  }

  /// One parent.
  Index operator()(Rng& rng) const {
    const auto n = static_cast<std::uint64_t>(fitness_.size());
    if (!wheel_.empty()) {
      const auto at = std::upper_bound(wheel_.begin(), wheel_.end(), rng.uniform() * wheel_.back());
      return std::min<Index>(at - wheel_.begin(), fitness_.size() - 1);
    }
    auto winner = static_cast<Index>(rng.below(n));
    for (int round = 1; round < tournament_; ++round) {
      const auto rival = static_cast<Index>(rng.below(n));
      if (fitness_(rival) < fitness_(winner)) winner = rival;
    }
    return winner;
  }

 private:
  const VectorX& fitness_;
  int tournament_;
  std::vector<double> wheel_;  ///< sums of the weights
};

/// Calls `hit(i)` for each of 0 .. count - 1 with a probability, jumping from hit to hit (geometric gaps).
template <class Hit>
void for_each_hit(double count, double probability, Rng& rng, Hit&& hit) {
  if (probability <= 0) return;
  const double log_miss = std::log1p(-std::min(probability, 1 - 1e-12));
  for (double at = -1;;) {
    at += 1 + std::floor(std::log1p(-rng.uniform()) / log_miss);
    if (!(at < count)) return;
    hit(static_cast<Index>(at));
  }
}

/// The first `count` places of a ranking by fitness, the best first; equals in their order.
inline std::vector<Index> best_of(const VectorX& fitness, Index count) {
  auto order = argsort(fitness);
  order.resize(static_cast<std::size_t>(count));
  return order;
}

/// The elites, then the children.
template <class Genes>
void replace_all_but(Index elites, Genes& genes, VectorX& fitness, const Genes& children, const VectorX& values) {
  Genes survivors(genes.rows(), genes.cols());
  VectorX kept(genes.cols());
  Index k = 0;
  for (const Index elite : best_of(fitness, elites)) {
    survivors.col(k) = genes.col(elite);
    kept(k++) = fitness(elite);
  }
  survivors.rightCols(children.cols()) = children;
  kept.tail(children.cols()) = values;
  genes.swap(survivors);
  fitness.swap(kept);
}

/// The best of old and new individuals, as many as there were; an old one where they are equal.
template <class Genes>
void keep_best_of_both(Genes& genes, VectorX& fitness, const Genes& children, const VectorX& values) {
  const Index n = genes.cols();
  Genes all(genes.rows(), n + children.cols());
  all << genes, children;
  VectorX joined(all.cols());
  joined << fitness, values;
  Index k = 0;
  for (const Index survivor : best_of(joined, n)) {
    genes.col(k) = all.col(survivor);
    fitness(k++) = joined(survivor);
  }
}

/// One generation of a genetic algorithm: children of chosen parents in pairs, crossed and mutated, take the place of
/// all but the elites.
/// @param ga     shows `selection`, `tournament`, `crossover_probability` and `elites`
/// @param s      its state, with `fitness`
/// @param genes  the individuals in it, one a column
/// @param cross  `cross(children, k)` crosses children k and k + 1
/// @param mutate `mutate(children)`
/// @param decode the points that genes stand for
/// @param evaluate as a search's
/// @param best_survive whether instead of elites and children the best of old and new ones survive
template <class Algorithm, class State, class Genes, class Cross, class Mutate, class Decode>
void next_generation(const Algorithm& ga, State& s, Genes& genes, Cross&& cross, Mutate&& mutate, Decode&& decode,
                     Evaluate evaluate, bool best_survive = false) {
  const Index n = genes.cols(), elites = best_survive ? 0 : ga.elites, count = n - elites;
  const ParentChoice parent(ga.selection, ga.tournament, s.fitness);
  Genes children(genes.rows(), count);
  for (Index k = 0; k < count; k += 2) {
    children.col(k) = genes.col(parent(s.rng));
    if (k + 1 == count) break;
    children.col(k + 1) = genes.col(parent(s.rng));
    if (s.rng.uniform() < ga.crossover_probability) cross(children, k);
  }
  mutate(children);

  const auto& points = decode(children);
  VectorX values;
  evaluate(points, values);
  s.keep_best(points, values);

  if (best_survive) {
    keep_best_of_both(genes, s.fitness, children, values);
  } else {
    replace_all_but(elites, genes, s.fitness, children, values);
  }
  ++s.generation;
}

}  // namespace vernier
