// SPDX-License-Identifier: BSD-3-Clause
// What the searches find, and what they cost beside the objective, against pagmo2's algorithms of the same name.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/algorithms/sga.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"
#include "vernier/evaluation/rank_tests.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/l_shade.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/spso2011.hpp"

namespace vn = vernier;

namespace {

constexpr const char* about =
    R"(search_medians_benchmark: what searches find in 30 dimensions with 30,000 evaluations, against pagmo2

First: the time of whole searches on the sphere, and of one evaluation beside the sphere itself.

Then: medians of the best values found over seeds 1 to 25, ours and pagmo2's, with the p of the two-sided rank-sum test
and a star where pagmo2's are lower at p < 0.01. All minima are 0 and shifted off the centre of the box; the ellipsoid
(axes 1 to 1000) is rotated. "equal" means equal constants, "own" each library's own defaults, at equal numbers of
evaluations. The best point evaluated counts, whether or not a population keeps it.

Nothing outside the box is evaluated: Vernier's default PSO, which may leave it, has its positions clamped, and pagmo2's
cmaes runs with force_bounds. Tolerances that would end a search before its budget are zero in "equal", and DE draws
coordinates outside the box anew there, as pagmo2 does. The last rows have no peer.

The medians take some minutes. pagmo2 is the library as installed.)";

constexpr vn::Index dimension = 30, budget = 30'000, seeds = 25;
constexpr unsigned swarm = 50, breed = 80, lambda = 14;

enum class Function { sphere, rosenbrock, rastrigin, ackley, ellipsoid, schwefel };
constexpr std::array functions{
    std::pair{Function::sphere, "sphere"},       std::pair{Function::rosenbrock, "Rosenbrock"},
    std::pair{Function::rastrigin, "Rastrigin"}, std::pair{Function::ackley, "Ackley"},
    std::pair{Function::ellipsoid, "ellipsoid"}, std::pair{Function::schwefel, "Schwefel"}};

/// An objective on a cube, the same for both libraries.
class Objective {
 public:
  explicit Objective(Function function) : function_(function), shift_(dimension), rotation_(dimension, dimension) {
    vn::Rng rng(2024 + static_cast<std::uint64_t>(function));
    // Schwefel's function falls below its minimum beyond -500: it is shifted one way only
    for (auto& s : shift_)
      s = half_width() * (function == Function::schwefel ? rng.uniform(-0.1, 0) : rng.uniform(-0.6, 0.6));
    for (auto& x : rotation_.reshaped()) x = rng.normal();
    rotation_ = vn::MatrixX(rotation_.householderQr().householderQ());
  }

  double half_width() const {
    switch (function_) {
      case Function::sphere: return 100;
      case Function::rosenbrock: return 10;
      case Function::rastrigin: return 5.12;
      case Function::ackley: return 32;
      case Function::ellipsoid: return 5;
      case Function::schwefel: return 500;
    }
    return 0;
  }

  double operator()(const double* x) const {
    const auto z = [&](vn::Index i) { return x[i] - shift_(i); };
    const auto n = static_cast<double>(dimension);
    double sum = 0, other = 0;
    switch (function_) {
      case Function::sphere:
        for (vn::Index i = 0; i < dimension; ++i) sum += z(i) * z(i);
        return sum;
      case Function::rosenbrock:
        for (vn::Index i = 0; i + 1 < dimension; ++i) {
          const double a = z(i) + 1, valley = z(i + 1) + 1 - a * a;
          sum += 100 * valley * valley + (1 - a) * (1 - a);
        }
        return sum;
      case Function::rastrigin:
        for (vn::Index i = 0; i < dimension; ++i) sum += 10 + z(i) * z(i) - 10 * std::cos(2 * std::numbers::pi * z(i));
        return sum;
      case Function::ackley:
        for (vn::Index i = 0; i < dimension; ++i) {
          sum += z(i) * z(i) / n;
          other += std::cos(2 * std::numbers::pi * z(i)) / n;
        }
        return -20 * std::exp(-0.2 * std::sqrt(sum)) - std::exp(other) + 20 + std::numbers::e;
      case Function::ellipsoid: {
        const vn::VectorX y = rotation_ * (Eigen::Map<const vn::VectorX>(x, dimension) - shift_);
        for (vn::Index i = 0; i < dimension; ++i)
          sum += std::pow(10.0, 6 * static_cast<double>(i) / (n - 1)) * y(i) * y(i);
        return sum;
      }
      case Function::schwefel:
        for (vn::Index i = 0; i < dimension; ++i) sum += 418.9828872724339 - z(i) * std::sin(std::sqrt(std::abs(z(i))));
        return sum;
    }
    return 0;
  }

 private:
  Function function_;
  vn::VectorX shift_;
  vn::MatrixX rotation_;
};

/// What a search evaluated.
struct Record {
  double best = std::numeric_limits<double>::infinity();
  vn::Index evaluations = 0;
};

/// A problem as pagmo2 wants it, which remembers the best point of all.
struct PagmoProblem {
  const Objective* objective = nullptr;
  Record* record = nullptr;
  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    const double value = (*objective)(x.data());
    record->best = std::min(record->best, value);
    ++record->evaluations;
    return {value};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const double width = objective == nullptr ? 1 : objective->half_width();
    return {pagmo::vector_double(dimension, -width), pagmo::vector_double(dimension, width)};
  }
};

/// pagmo2's search by an algorithm, from a population of its own.
template <class Algorithm>
Record peer(const Algorithm& algorithm, unsigned individuals, const Objective& objective, unsigned seed) {
  Record record;
  const pagmo::population found =
      algorithm.evolve(pagmo::population(pagmo::problem(PagmoProblem{&objective, &record}), individuals, seed));
  return record;
}

/// Ours.
template <class Algorithm>
Record ours(const Algorithm& algorithm, const Objective& objective, unsigned seed) {
  const auto result = vn::minimize(
      algorithm, [&](const vn::VectorX& x) { return objective(x.data()); },
      vn::Box::cube(dimension, -objective.half_width(), objective.half_width()), {.max_evaluations = budget}, seed);
  return {result.best_fitness, result.evaluations};
}

constexpr unsigned generations_of(unsigned individuals) { return static_cast<unsigned>(budget) / individuals - 1; }

vn::Pso constriction(vn::Neighbourhood neighbourhood) {
  vn::Pso pso = vn::Pso::constriction();
  pso.particles = swarm;
  pso.iterations = generations_of(swarm);
  pso.neighbourhood = neighbourhood;
  return pso;
}
pagmo::pso_gen equal_pso(unsigned seed) {
  return pagmo::pso_gen(generations_of(swarm), 0.729843788, 1.49618, 1.49618, 0.5, 1, 1, 4, false, seed);
}
pagmo::pso_gen own_pso(unsigned seed) {
  pagmo::pso_gen algorithm(generations_of(swarm));
  algorithm.set_seed(seed);
  return algorithm;
}
const vn::RealGeneticAlgorithm real_ga{.individuals = breed, .generations = budget};
pagmo::sga equal_sga(unsigned seed) {
  return pagmo::sga(generations_of(breed), 0.9, 15, 1.0 / dimension, 20, 2, "sbx", "polynomial", "tournament", seed);
}
pagmo::sga own_sga(unsigned seed) {
  pagmo::sga algorithm(generations_of(breed));
  algorithm.set_seed(seed);
  return algorithm;
}
vn::DifferentialEvolution de(vn::DifferentialBase base, vn::TrialRule rule = vn::TrialRule::redrawn) {
  return {.generations = budget, .base = base, .trials_outside = rule};
}
pagmo::de equal_de(unsigned variant, unsigned seed) {
  return pagmo::de(generations_of(swarm), 0.5, 0.9, variant, 0, 0, seed);
}
pagmo::de own_de(unsigned seed) {
  pagmo::de algorithm(generations_of(swarm));
  algorithm.set_seed(seed);
  return algorithm;
}
const vn::CmaEs cma{.generations = budget, .restarts = 9},
    cma_once{.generations = budget, .tolerance_x = 0, .tolerance_f = 0};
pagmo::cmaes equal_cma(const Objective& objective, unsigned seed) {
  return pagmo::cmaes(generations_of(lambda), -1, -1, -1, -1, 0.6 * objective.half_width(), 0, 0, false, true, seed);
}
pagmo::cmaes own_cma(unsigned seed) {
  return pagmo::cmaes(generations_of(lambda), -1, -1, -1, -1, 0.5, 1e-6, 1e-6, false, true, seed);
}

template <class Search>
vn::VectorX values(const Search& search) {
  vn::VectorX out(seeds);
  for (vn::Index i = 0; i < seeds; ++i) {
    const Record record = search(static_cast<unsigned>(i + 1));
    if (record.evaluations > budget) throw std::runtime_error("a search made more evaluations than it may");
    out(i) = record.best;
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// A line of medians: ours, theirs, p; one function after the other.
template <class Ours, class Theirs>
void compare(const char* name, const Ours& of_ours, const Theirs& of_theirs) {
  std::printf("%-24s", name);
  for (const auto& [function, ignored] : functions) {
    const Objective objective(function);
    const vn::VectorX a = values([&](unsigned seed) { return of_ours(objective, seed); }),
                      b = values([&](unsigned seed) { return of_theirs(objective, seed); });
    const vn::RankTest test = vn::rank_sum_test(a, b);
    const bool worse = test.p_value < 0.01 && test.statistic > static_cast<double>(seeds * seeds) / 2;
    std::printf("  %9.3g %9.3g %7.1g%s", a(seeds / 2), b(seeds / 2), test.p_value, worse ? "*" : " ");
    std::fflush(stdout);
  }
  std::printf("\n");
}

template <class Ours>
void alone(const char* name, const Ours& of_ours) {
  std::printf("%-24s", name);
  for (const auto& [function, ignored] : functions) {
    const Objective objective(function);
    std::printf("  %9.3g %18s", values([&](unsigned seed) { return of_ours(objective, seed); })(seeds / 2), "");
    std::fflush(stdout);
  }
  std::printf("\n");
}

int work(bench::Program& program, int argc, char** argv) {
  static const Objective sphere(Function::sphere);
  const auto measure = [&program](const char* topic, const auto& by_us, const char* who, const auto& by_them) {
    program.measure(topic, "vernier", [by_us](std::size_t i) { return by_us(static_cast<unsigned>(i)).best; });
    program.measure(topic, who, [by_them](std::size_t i) { return by_them(static_cast<unsigned>(i)).best; });
  };
  measure(
      "PSO", [](unsigned seed) { return ours(constriction(vn::Neighbourhood::global), sphere, seed); },
      "pagmo2 pso_gen", [](unsigned seed) { return peer(equal_pso(seed), swarm, sphere, seed); });
  measure(
      "real-coded GA", [](unsigned seed) { return ours(real_ga, sphere, seed); }, "pagmo2 sga",
      [](unsigned seed) { return peer(equal_sga(seed), breed, sphere, seed); });
  measure(
      "DE", [](unsigned seed) { return ours(de(vn::DifferentialBase::random), sphere, seed); }, "pagmo2 de",
      [](unsigned seed) { return peer(equal_de(7, seed), swarm, sphere, seed); });
  // no tolerances, so that neither stops before its budget
  static const vn::CmaEs endless{.generations = budget, .restarts = 30, .tolerance_x = 0, .tolerance_f = 0};
  measure(
      "CMA-ES", [](unsigned seed) { return ours(endless, sphere, seed); }, "pagmo2 cmaes",
      [](unsigned seed) { return peer(equal_cma(sphere, seed), lambda, sphere, seed); });
  const auto alone_too = [&program](const char* topic, const auto& by_us) {
    program.measure(topic, "vernier", [by_us](std::size_t i) { return by_us(static_cast<unsigned>(i)).best; });
  };
  alone_too("SPSO 2011", [](unsigned seed) { return ours(vn::Spso2011{.iterations = budget}, sphere, seed); });
  alone_too("L-SHADE", [](unsigned seed) { return ours(vn::LShade{.max_evaluations = budget}, sphere, seed); });
  alone_too("random search", [](unsigned seed) { return ours(vn::RandomSearch{.generations = budget}, sphere, seed); });
  program.measure("sphere alone", "no search", [](std::size_t) {
    static const vn::MatrixX points = vn::MatrixX::Random(dimension, swarm);
    double sum = 0;
    for (vn::Index k = 0; k < budget; ++k) {
      double one = sphere(points.col(k % swarm).data());
      benchmark::DoNotOptimize(one);
      sum += one;
    }
    return sum;
  });
  if (const int status = program.run(argc, argv); status != 0) return status;
  if (const double base = program.median("sphere alone", "no search"); base > 0) {
    const auto beside = [&](const char* topic, const char* who) {
      const double time = program.median(topic, who);
      return time > 0 ? bench::duration((time - base) / static_cast<double>(budget)) : std::string("-");
    };
    std::printf("\none evaluation beside the sphere itself (%s)\n", bench::duration(base / budget).c_str());
    for (const auto& [topic, who] : {std::pair{"PSO", "pagmo2 pso_gen"},
                                     {"real-coded GA", "pagmo2 sga"},
                                     {"DE", "pagmo2 de"},
                                     {"CMA-ES", "pagmo2 cmaes"},
                                     {"SPSO 2011", ""},
                                     {"L-SHADE", ""},
                                     {"random search", ""}})
      std::printf("  %-20s vernier %10s   pagmo2 %10s\n", topic, beside(topic, "vernier").c_str(),
                  beside(topic, who).c_str());
  }
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]).starts_with("--benchmark_list_tests")) return 0;

  std::printf("\nmedians of %ld seeds, %ld evaluations: vernier, pagmo2, p\n%-24s", static_cast<long>(seeds),
              static_cast<long>(budget), "");
  for (const auto& [ignored, name] : functions) std::printf("  %-28s", name);
  std::printf("\n");
  const auto run = [](const auto& algorithm) {
    return [algorithm](const Objective& objective, unsigned seed) { return ours(algorithm, objective, seed); };
  };
  const auto with = [](unsigned individuals, const auto& make) {
    return [individuals, make](const Objective& objective, unsigned seed) {
      return peer(make(objective, seed), individuals, objective, seed);
    };
  };
  const vn::Pso paper{.particles = swarm, .iterations = generations_of(swarm), .positions = vn::PositionRule::clamped};
  compare("PSO, equal", run(constriction(vn::Neighbourhood::global)),
          with(swarm, [](const Objective&, unsigned seed) { return equal_pso(seed); }));
  compare("PSO, own", run(paper), with(swarm, [](const Objective&, unsigned seed) { return own_pso(seed); }));
  compare("PSO, 4 neighbours, own", run(constriction(vn::Neighbourhood::von_neumann)),
          with(swarm, [](const Objective&, unsigned seed) { return own_pso(seed); }));
  compare("real GA, equal", run(real_ga), with(breed, [](const Objective&, unsigned seed) { return equal_sga(seed); }));
  // sga's polynomial mutation steps in proportion to the distance from a bound: in the middle of the box half as far
  vn::RealGeneticAlgorithm half_steps = real_ga;
  half_steps.mutation_index = 41;
  compare("real GA, equal steps", run(half_steps),
          with(breed, [](const Objective&, unsigned seed) { return equal_sga(seed); }));
  compare("real GA, own", run(real_ga), with(breed, [](const Objective&, unsigned seed) { return own_sga(seed); }));
  compare("DE rand/1/bin, equal", run(de(vn::DifferentialBase::random)),
          with(swarm, [](const Objective&, unsigned seed) { return equal_de(7, seed); }));
  compare("DE best/1/bin, equal", run(de(vn::DifferentialBase::best)),
          with(swarm, [](const Objective&, unsigned seed) { return equal_de(6, seed); }));
  compare("DE, own", run(de(vn::DifferentialBase::random, vn::TrialRule::halfway)),
          with(swarm, [](const Objective&, unsigned seed) { return own_de(seed); }));
  compare("CMA-ES, one run, equal", run(cma_once),
          with(lambda, [](const Objective& objective, unsigned seed) { return equal_cma(objective, seed); }));
  compare("CMA-ES, own (IPOP)", run(cma), with(lambda, [](const Objective&, unsigned seed) { return own_cma(seed); }));
  alone("PSO, ring", run(constriction(vn::Neighbourhood::ring)));
  alone("SPSO 2011", run(vn::Spso2011{.iterations = budget}));
  alone("L-SHADE", run(vn::LShade{.max_evaluations = budget}));
  alone("random search", run(vn::RandomSearch{.generations = budget}));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_program(about, argc, argv, [&](bench::Program& program) { return work(program, argc, argv); });
}
