// SPDX-License-Identifier: BSD-3-Clause
// Tune the hidden weights instead of drawing them: PSO-ELM and GA-ELM are one line each.

#include <cstdio>
#include <vernier/kinematics/robots.hpp>
#include <vernier/regression/elm.hpp>
#include <vernier/search/genetic_algorithm.hpp>
#include <vernier/search/pso.hpp>
#include <vernier/search/tuned.hpp>
#include <vernier/simulation/sampling.hpp>
#include <vernier/simulation/virtual_robot.hpp>

namespace vn = vernier;

int main() {
  const auto nominal = vn::robots::abb_irb120().chain;
  const auto actual = vn::with_geometric_errors(nominal, {}, /*seed=*/1);
  const auto region = vn::abb_irb120_operating_region();
  const auto train = vn::measure(actual, region.sample(nominal, 400, 1));
  const auto test = vn::measure(actual, region.sample(nominal, 400, 2));
  const vn::PointRows error = vn::positions(nominal, train.joints()) - train.positions();
  const vn::PointRows fresh = vn::positions(nominal, test.joints()) - test.positions();

  // Any regressor with inner weights, any search: the two know nothing of each other.
  const vn::Elm elm{.hidden_nodes = 30};
  const vn::Tuned pso_elm{elm, vn::Pso{.particles = 30, .iterations = 40}};
  const vn::Tuned ga_elm{elm, vn::GeneticAlgorithm{.individuals = 30, .generations = 40}};

  // An observer sees every generation; the fitness is the training error in scaled targets.
  const auto watch = [](const vn::Progress& p) {
    if (p.generation % 10 == 0)
      std::printf("  generation %2td  %5td evaluations  fitness %.5f\n", p.generation, p.evaluations, p.best);
  };
  const auto report = [&](const char* name, const auto& predictor) {
    std::printf("%-12s mean error on fresh poses %.3f mm\n", name,
                (predictor.predict(test.joints()) - fresh).rowwise().norm().mean() * 1e3);
  };
  std::printf("%-12s mean error on fresh poses %.3f mm\n", "uncorrected", fresh.rowwise().norm().mean() * 1e3);
  report("ELM", elm.fit(train.joints(), error, {.seed = 1}));
  report("PSO-ELM", pso_elm.fit(train.joints(), error, {.seed = 1, .observer = watch}));
  report("GA-ELM", ga_elm.fit(train.joints(), error, {.seed = 1, .observer = watch}));

  // The same seed gives the same bits, however many threads evaluate.
  vn::ThreadExecutor threads(2);
  report("and again", pso_elm.fit(train.joints(), error, {.seed = 1, .executor = threads}));
}
