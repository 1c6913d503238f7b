// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Hybrids fitted to samples whose numbers of inputs and outputs are known at run time.

#include "vernier/core/check.hpp"
#include "vernier/regression/any_predictor.hpp"
#include "vernier/search/tuned.hpp"

namespace vernier {

/// Searches hidden weights, then fits at the best ones, as `Tuned::fit` does for fixed numbers of inputs and outputs:
/// `fit_any(Tuned{Elm{}, Pso{}}, inputs, targets)`.
/// @param tuned   of `Elm`, `RidgeElm` or `VarProElm`; it searches on all samples
/// @param inputs  n x inputs
/// @param targets n x outputs
/// @param options seed, executor, observer, weights
/// @throws std::invalid_argument for unusable samples, weights or options
template <class R, class A>
AnyPredictor fit_any(const Tuned<R, A>& tuned, const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                     const FitOptions& options = {}) {
  demand(tuned.search_samples == 0, "fit_any: a search on a part of the samples needs fixed numbers of columns");
  const auto objective = detail::RunTimeFit::objective(tuned.regressor, inputs, targets, options.weights);
  const SearchResult found = minimize(tuned.algorithm, objective, tuned.regressor.box(static_cast<int>(inputs.cols())),
                                      tuned.stop, options.seed, options.executor, options.observer);
  const auto further = [&](const Progress& p) {
    return options.observer(Progress{found.generations + p.generation, found.evaluations + p.evaluations, p.best});
  };
  const FitOptions rest{options.seed, options.executor, further, options.weights};
  return {detail::RunTimeFit::at(tuned.regressor, inputs, targets, found.best, rest), inputs.cols()};
}

}  // namespace vernier
