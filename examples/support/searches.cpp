#include "searches.hpp"

#include <algorithm>
#include <limits>

#include "comparison.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"

namespace support {

namespace {

namespace vn = vernier;

/// Named random search: what every other one has to beat.
constexpr int population = 50;

}  // namespace

const std::vector<Named>& search_names() {
  static const std::vector<Named> names{
      {"pso", "PSO as in the paper: falling inertia, particles may leave the box"},
      {"pso_clamped", "the same, particles kept in the box"},
      {"ga", "binary genetic algorithm with the paper's constants"},
  };
  return names;
}

vn::SearchResult run_search(const std::string& name, const AnyObjective& objective, const vn::Box& box,
                            vn::Index evaluations, std::uint64_t seed, vn::ObserverRef observer) {
  const vn::Stop stop{.max_evaluations = evaluations};
  const vn::Index generations = std::max<vn::Index>(0, evaluations / population - 1);
  const auto run = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, stop, seed, {}, observer);
  };
  if (name == "pso") return run(vn::Pso{.particles = population, .iterations = generations});
  if (name == "pso_clamped")
    return run(vn::Pso{.particles = population, .iterations = generations, .positions = vn::PositionRule::clamped});
  if (name == "ga") return run(vn::GeneticAlgorithm{.individuals = population, .generations = generations});
  throw std::logic_error("no search is called " + name);
}

}  // namespace support
