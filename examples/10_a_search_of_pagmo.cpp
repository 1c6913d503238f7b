// SPDX-License-Identifier: BSD-3-Clause
// A search from another library: pagmo2's algorithms through an adapter (support/pagmo_search.hpp), under the same
// laws, in the same places.

#include <cstdio>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <vernier/compensation/cartesian.hpp>
#include <vernier/evaluation/position_errors.hpp>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/elm.hpp>
#include <vernier/search/pso.hpp>
#include <vernier/search/tuned.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>
#include <vernier/testing/metaheuristic_laws.hpp>

#include "support/pagmo_search.hpp"

namespace vn = vernier;

int main() {
  using support::PagmoSearch;
  const PagmoSearch pso{PagmoSearch::whole_generations(pagmo::pso_gen(1, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true)), 20,
                        60};
  const PagmoSearch ants{
      PagmoSearch::whole_generations(pagmo::gaco(1, 13, 1.0, 0.0, 0.01, 7, 100, 100000, 100000, 0.0, true)), 20, 60};
  static_assert(vn::Metaheuristic<PagmoSearch>);
  for (const auto* search : {&pso, &ants}) {
    const auto violations = vn::testing::metaheuristic_violations(*search, /*keeps_box=*/true);
    for (const auto& violation : violations) std::printf("broken law: %s\n", violation.c_str());
    if (!violations.empty()) return 1;
    std::printf("%s obeys the laws of metaheuristics\n", search->algorithm.get_name().c_str());
  }

  const auto nominal = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);
  const auto region = vn::abb_irb120_operating_region();
  const auto train = vn::measure(actual, region.sample(nominal, 300, 1));
  const auto test = vn::measure(actual, region.sample(nominal, 300, 2));
  const vn::Elm elm{.hidden_nodes = 25};
  const auto report = [&](const char* name, const auto& regressor) {
    const auto fitted = vn::CartesianCompensation{regressor}.fit(nominal, train, {.seed = 1});
    std::printf("  %-28s %.3f mm\n", name, vn::prediction_error(fitted, test).mean * 1e3);
  };
  std::printf("mean error on 300 fresh poses, 1220 evaluations each:\n");
  report("ELM", elm);
  report("pagmo2's ant colony", vn::Tuned{elm, ants});
  report("pagmo2's PSO", vn::Tuned{elm, pso});
  report("PSO", vn::Tuned{elm, vn::Pso{.particles = 20, .iterations = 60}});
}
