// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Operators of genetic algorithms that do not depend on the encoding: mutation points, survival, one generation.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vernier/core/argsort.hpp"
#include "vernier/search/parent_selection.hpp"
#include "vernier/search/state.hpp"

namespace vernier::detail {

/// Calls `hit(i)` for each of 0 .. count - 1 with a probability, drawing the gaps between hits (geometric).
template <class Hit>
void for_each_hit(double count, double probability, Rng& rng, Hit&& hit) {
  if (probability <= 0) return;
  const double log_miss = std::log1p(-(std::min)(probability, 1 - 1e-12));
  for (double at = -1;;) {
    at += 1 + std::floor(std::log1p(-rng.uniform()) / log_miss);
    if (!(at < count)) return;
    hit(static_cast<Index>(at));
  }
}

/// The best individuals, `elites` of them, then the children.
template <class Genes>
void replace_all_but(Index elites, Genes& genes, VectorX& fitness, const Genes& children, const VectorX& values) {
  Genes survivors(genes.rows(), genes.cols());
  VectorX kept(genes.cols());
  Index k = 0;
  for (const auto order = argsort(fitness); k < elites; ++k) {
    const Index elite = order[static_cast<std::size_t>(k)];
    survivors.col(k) = genes.col(elite);
    kept(k) = fitness(elite);
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
  all.leftCols(n) = genes;
  all.rightCols(children.cols()) = children;
  VectorX joined(all.cols());
  joined.head(n) = fitness;
  joined.tail(values.size()) = values;
  const auto order = argsort(joined);
  for (Index k = 0; k < n; ++k) {
    const Index survivor = order[static_cast<std::size_t>(k)];
    genes.col(k) = all.col(survivor);
    fitness(k) = joined(survivor);
  }
}

/// One generation of a genetic algorithm: children of selected parents in pairs, crossed and mutated, replace all but
/// the elites.
/// @param ga     has `selection`, `tournament`, `crossover_probability` and `elites`
/// @param s      its state, with `fitness`
/// @param genes  its individuals, one per column
/// @param cross  `cross(children, k)` crosses children k and k + 1
/// @param mutate `mutate(children)`
/// @param decode the points that genes encode
/// @param evaluate as a search's
/// @param best_survive whether the best of old and new individuals survive instead of elites and children
template <class Algorithm, class State, class Genes, class Cross, class Mutate, class Decode>
void next_generation(const Algorithm& ga, State& s, Genes& genes, Cross&& cross, Mutate&& mutate, Decode&& decode,
                     Evaluate evaluate, bool best_survive = false) {
  const Index n = genes.cols(), elites = best_survive ? 0 : ga.elites, count = n - elites;
  const ParentSelector parent(ga.selection, ga.tournament, s.fitness);
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

}  // namespace vernier::detail
