#include "calibration_stages.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"

namespace support {

vernier::VectorX search_priors(const vernier::PriorObjective& objective, const vernier::Box& box, bool genetic,
                               const vernier::FitOptions& options) {
  namespace vn = vernier;
  const auto best = [&](const auto& algorithm) {
    return vn::minimize(algorithm, objective, box, {}, options.seed, options.executor, options.observer).best;
  };
  if (genetic) return best(vn::GeneticAlgorithm{.individuals = 20, .generations = prior_generations});
  return best(vn::Pso{.particles = 20, .iterations = prior_generations, .positions = vn::PositionRule::clamped});
}

}  // namespace support
