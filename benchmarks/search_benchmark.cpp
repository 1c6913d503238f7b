// SPDX-License-Identifier: BSD-3-Clause
// What particle swarm optimization costs beside the objective, and what it finds, against pagmo2.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <vector>

#include "program.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"

namespace vn = vernier;

namespace {

constexpr const char* about =
    R"(search_benchmark: particle swarm optimization in 30 dimensions, against pagmo2's pso_gen

  15,050 evaluations   a whole search on the sphere: 50 particles drawn and evaluated, then 300 generations. Both swarms
                       have a global best, inertia 0.7298, both pulls 1.49618, velocities limited to half the width of
                       the box and positions kept in it. "sphere alone" evaluates the sphere as often and does nothing
                       else.

Then: the cost of one evaluation beside the sphere itself, and the median of the best values found over seeds 1 to 10 on
sphere [-5.12, 5.12], Rosenbrock [-2.048, 2.048] and Rastrigin [-5.12, 5.12] at equal numbers of evaluations, once with
the constants above, once with each library's own defaults (Vernier: the paper's falling inertia and no bounds on
positions; pagmo2: constriction, a ring of neighbours).

pagmo2 is the library as installed; its headers are compiled with the flags of this program.)";

constexpr vn::Index dimension = 30, particles = 50, generations = 300, evaluations = particles * (generations + 1);

enum class Function { sphere, rosenbrock, rastrigin };

double half_width(Function function) { return function == Function::rosenbrock ? 2.048 : 5.12; }

/// The objectives, one text for both libraries; `at(i)` is a coordinate.
template <class At>
double value(Function function, const At& at) {
  double sum = 0;
  switch (function) {
    case Function::sphere:
      for (vn::Index i = 0; i < dimension; ++i) sum += at(i) * at(i);
      break;
    case Function::rosenbrock:
      for (vn::Index i = 0; i + 1 < dimension; ++i) {
        const double valley = at(i + 1) - at(i) * at(i), slope = 1 - at(i);
        sum += 100 * valley * valley + slope * slope;
      }
      break;
    case Function::rastrigin:
      for (vn::Index i = 0; i < dimension; ++i) sum += 10 + at(i) * at(i) - 10 * std::cos(2 * std::numbers::pi * at(i));
      break;
  }
  return sum;
}

/// A problem as pagmo2 wants it.
struct PagmoProblem {
  Function function = Function::sphere;
  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    return {value(function, [&](vn::Index i) { return x[static_cast<std::size_t>(i)]; })};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const double width = half_width(function);
    return {pagmo::vector_double(dimension, -width), pagmo::vector_double(dimension, width)};
  }
};

vn::Pso equal_pso() {
  return {.particles = particles,
          .iterations = generations,
          .inertia_start = 0.7298,
          .inertia_end = 0.7298,
          .cognitive = 1.49618,
          .social = 1.49618,
          .positions = vn::PositionRule::clamped};
}

pagmo::pso_gen equal_pso_gen(unsigned seed) {
  return pagmo::pso_gen(generations, 0.7298, 1.49618, 1.49618, 0.5, 1, 1, 4, false, seed);
}

pagmo::pso_gen default_pso_gen(unsigned seed) {
  pagmo::pso_gen algorithm(generations);
  algorithm.set_seed(seed);
  return algorithm;
}

vn::SearchResult search(const vn::Pso& pso, Function function, std::uint64_t seed) {
  const double width = half_width(function);
  return vn::minimize(
      pso, [function](const vn::VectorX& x) { return value(function, [&](vn::Index i) { return x(i); }); },
      vn::Box::cube(dimension, -width, width), {}, seed);
}

pagmo::population search(const pagmo::pso_gen& algorithm, Function function, unsigned seed) {
  return algorithm.evolve(pagmo::population(pagmo::problem(PagmoProblem{function}), particles, seed));
}

template <class Found>
double median_of_ten(const Found& found) {
  std::vector<double> values;
  for (unsigned seed = 1; seed <= 10; ++seed) values.push_back(found(seed));
  std::sort(values.begin(), values.end());
  return (values[4] + values[5]) / 2;
}

int work(bench::Program& program, int argc, char** argv) {
  const vn::SearchResult ours = search(equal_pso(), Function::sphere, 1);
  const pagmo::population theirs = search(equal_pso_gen(1), Function::sphere, 1);
  if (ours.evaluations != evaluations || theirs.get_problem().get_fevals() != evaluations)
    throw std::runtime_error("the libraries evaluate unequal numbers of points");

  const char* topic = "15,050 evaluations";
  program.measure(topic, "vernier",
                  [pso = equal_pso()](std::size_t i) { return search(pso, Function::sphere, i).best_fitness; });
  program.measure(topic, "pagmo2 pso_gen", [](std::size_t i) {
    const auto seed = static_cast<unsigned>(i);
    return search(equal_pso_gen(seed), Function::sphere, seed).champion_f()[0];
  });
  program.measure("sphere alone", "no search", [swarm = vn::MatrixX::Random(dimension, particles).eval()](std::size_t) {
    double sum = 0;
    for (vn::Index k = 0; k < evaluations; ++k) {
      const auto x = swarm.col(k % particles);
      double one = value(Function::sphere, [&](vn::Index i) { return x(i); });
      benchmark::DoNotOptimize(one);
      sum += one;
    }
    return sum;
  });

  if (const int status = program.run(argc, argv); status != 0) return status;
  const double sphere = program.median("sphere alone", "no search"), vernier = program.median(topic, "vernier"),
               pagmo = program.median(topic, "pagmo2 pso_gen");
  if (sphere > 0 && vernier > 0 && pagmo > 0) {
    const double count = static_cast<double>(evaluations);
    std::printf("\none evaluation beside the sphere itself (%s): vernier %s, pagmo2 %s\n",
                bench::duration(sphere / count).c_str(), bench::duration((vernier - sphere) / count).c_str(),
                bench::duration((pagmo - sphere) / count).c_str());
    std::printf("ratio  %-26s %-30s %7.2f\n", "beside the sphere", "pagmo2 pso_gen",
                (pagmo - sphere) / (vernier - sphere));
  }

  std::printf("\nmedian of the best values found, 10 seeds, %ld evaluations\n%-12s %14s %14s   %14s %14s\n",
              static_cast<long>(evaluations), "", "vernier", "pagmo2", "own defaults:", "");
  for (const auto& [function, name] : {std::pair{Function::sphere, "sphere"},
                                       {Function::rosenbrock, "Rosenbrock"},
                                       {Function::rastrigin, "Rastrigin"}}) {
    const auto f = function;
    const vn::Pso paper{.particles = particles, .iterations = generations};
    std::printf("%-12s %14.4g %14.4g   %14.4g %14.4g\n", name,
                median_of_ten([&](unsigned seed) { return search(equal_pso(), f, seed).best_fitness; }),
                median_of_ten([&](unsigned seed) { return search(equal_pso_gen(seed), f, seed).champion_f()[0]; }),
                median_of_ten([&](unsigned seed) { return search(paper, f, seed).best_fitness; }),
                median_of_ten([&](unsigned seed) { return search(default_pso_gen(seed), f, seed).champion_f()[0]; }));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
