// SPDX-License-Identifier: BSD-3-Clause
#include "searches.hpp"

#include <algorithm>
#include <limits>

#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/spso2011.hpp"
#ifdef VERNIER_HAS_PAGMO
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/pso_gen.hpp>

#include "pagmo_search.hpp"
#endif

namespace support {

namespace {

namespace vn = vernier;

constexpr int population = 50;

}  // namespace

vn::SearchResult run_search(const std::string& name, const AnyObjective& objective, const vn::Box& box,
                            vn::Index evaluations, std::uint64_t seed, vn::ObserverRef observer) {
  const vn::StoppingCriteria stop{.max_evaluations = evaluations};
  const vn::Index generations = std::max<vn::Index>(0, evaluations / population - 1);
  const auto run = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, stop, seed, {}, observer);
  };
  if (name == "pso") return run(vn::Pso{.particles = population, .iterations = generations});
  if (name == "pso_clamped")
    return run(vn::Pso{.particles = population, .iterations = generations, .positions = vn::PositionRule::clamped});
  if (name == "pso_constriction") {
    vn::Pso pso = vn::Pso::constriction();
    pso.particles = population;
    pso.iterations = generations;
    pso.neighbourhood = vn::Neighbourhood::ring;
    return run(pso);
  }
  if (name == "spso2011") return run(vn::Spso2011{.particles = population, .iterations = generations});
  if (name == "ga") return run(vn::GeneticAlgorithm{.individuals = population, .generations = generations});
  if (name == "real_ga") return run(vn::RealGeneticAlgorithm{.individuals = population, .generations = generations});
  if (name == "de") return run(vn::DifferentialEvolution{.individuals = population, .generations = generations});
  if (name == "lshade")  // the published 18 a dimension would not get beyond its first population here
    return run(vn::LShade{.max_evaluations = evaluations,
                          .individuals_per_dimension = 2.0 * population / static_cast<double>(box.dimension())});
  if (name == "cmaes") return run(vn::CmaEs{.individuals = population, .generations = evaluations});
  if (name == "random") return run(vn::RandomSearch{.individuals = population, .generations = generations});
#ifdef VERNIER_HAS_PAGMO
  const auto run_pagmo = [&](const auto& algorithm) {
    return run(PagmoSearch{PagmoSearch::whole_generations(algorithm), population, generations});
  };
  if (name == "pagmo_pso") return run_pagmo(pagmo::pso_gen(1, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true));
  if (name == "pagmo_gaco") return run_pagmo(pagmo::gaco(1, 13, 1.0, 0.0, 0.01, 7, 100, 100000, 100000, 0.0, true));
#endif
  throw std::logic_error("no search is called " + name);
}

}  // namespace support
