// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "vernier/core/check.hpp"
#include "vernier/search/cma_es.hpp"
#include "vernier/search/differential_evolution.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/minimize.hpp"
#include "vernier/search/pso.hpp"
#include "vernier/search/random_search.hpp"
#include "vernier/search/real_genetic_algorithm.hpp"
#include "vernier/search/spso2011.hpp"

namespace python {

namespace {

namespace vn = vernier;

const char* word(vn::SearchStatus status) {
  switch (status) {
    case vn::SearchStatus::schedule_ended: return "schedule_ended";
    case vn::SearchStatus::budget_spent: return "budget_spent";
    case vn::SearchStatus::target_reached: return "target_reached";
    case vn::SearchStatus::stalled: return "stalled";
    case vn::SearchStatus::observer_stopped: return "observer_stopped";
  }
  return "";
}

/// Calls `use` with a search; 0 leaves its size or schedule as it is.
template <class Use>
vn::SearchResult with_method(const std::string& method, int population, vn::Index generations, const Use& use) {
  const auto with = [&](auto search, auto size, auto steps) {
    if (population > 0) search.*size = population;
    if (generations > 0) search.*steps = generations;
    return use(search);
  };
  if (method == "pso") return with(vn::Pso{}, &vn::Pso::particles, &vn::Pso::iterations);
  if (method == "spso2011") return with(vn::Spso2011{}, &vn::Spso2011::particles, &vn::Spso2011::iterations);
  if (method == "ga")
    return with(vn::GeneticAlgorithm{}, &vn::GeneticAlgorithm::individuals, &vn::GeneticAlgorithm::generations);
  if (method == "real_ga")
    return with(vn::RealGeneticAlgorithm{}, &vn::RealGeneticAlgorithm::individuals,
                &vn::RealGeneticAlgorithm::generations);
  if (method == "de")
    return with(vn::DifferentialEvolution{}, &vn::DifferentialEvolution::individuals,
                &vn::DifferentialEvolution::generations);
  if (method == "cma_es") return with(vn::CmaEs{}, &vn::CmaEs::individuals, &vn::CmaEs::generations);
  if (method == "random")
    return with(vn::RandomSearch{}, &vn::RandomSearch::individuals, &vn::RandomSearch::generations);
  throw std::invalid_argument("minimize: no method is called '" + method +
                              "'; there are pso, spso2011, ga, real_ga, de, cma_es, random");
}

py::object minimize(const py::function& f, const py::object& lower, const py::object& upper, const std::string& method,
                    std::uint64_t seed, int population, vn::Index generations,
                    const std::optional<vn::Index>& max_evaluations, const std::optional<double>& target,
                    const std::optional<vn::Index>& patience, const py::object& progress) {
  const Array low = numbers(lower, "lower");
  vn::demand(low.ndim() == 1 && low.size() >= 1, "lower: one bound a variable is expected");
  vn::demand(population >= 0 && generations >= 0, "minimize: population and generations must not be negative");
  const vn::Box box{vector_of(lower, "lower", low.size()), vector_of(upper, "upper", low.size())};
  vn::StoppingCriteria stop;
  if (max_evaluations) stop.max_evaluations = *max_evaluations;
  if (target) stop.target = *target;
  if (patience) stop.patience = *patience;
  const auto objective = [&](const vn::ConstMatrixRef& points, vn::VectorRef fitness) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    Array rows({points.cols(), points.rows()});
    double* to = rows.mutable_data();
    for (vn::Index i = 0; i < points.cols(); ++i)
      for (vn::Index k = 0; k < points.rows(); ++k) *to++ = points(k, i);
    const Array values = numbers(f(rows), "the objective");
    vn::demand(values.ndim() == 1 && values.shape(0) == points.cols(),
               "minimize: the objective gets points of shape (n, variables) and returns n values; it returned ",
               values.size(), " for ", points.cols(), " points");
    for (vn::Index i = 0; i < points.cols(); ++i) fitness(i) = values.data()[i];
  };
  const auto observer = [&](const vn::Progress& now) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(now);
  };
  const vn::SearchResult found = with_method(method, population, generations, [&](const auto& search) {
    return vn::minimize(search, objective, box, stop, seed, {}, observer);
  });
  return py::module_::import("vernier.results")
      .attr("SearchResult")(array_of(found.best), found.best_fitness, found.evaluations, found.generations,
                            word(found.status));
}

}  // namespace

void bind_minimize(py::module_& module) {
  const auto none = py::none();
  module.def("minimize", &minimize, py::arg("f"), py::arg("lower"), py::arg("upper"), py::kw_only(),
             py::arg("method") = "pso", py::arg("seed") = 0, py::arg("population") = 0, py::arg("generations") = 0,
             py::arg("max_evaluations") = none, py::arg("target") = none, py::arg("patience") = none,
             py::arg("progress") = none,
             "Searches a box for the minimum of f, which gets whole populations, (n, variables), and returns n values; "
             "it is called on the calling thread. method is pso, spso2011, ga, real_ga, de, cma_es or random; 0 leaves "
             "population and generations as the method has them.");
}

}  // namespace python
