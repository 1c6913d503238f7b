// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/rng.hpp"
#include "vernier/regression/detail/common_scaling.hpp"
#include "vernier/regression/detail/levenberg_marquardt.hpp"
#include "vernier/regression/detail/variable_projection.hpp"
#include "vernier/regression/var_pro_elm.hpp"

namespace vernier {

VERNIER_IMPL Box VarProElm::box(int inputs) const { return layer().box(inputs); }

VERNIER_IMPL void VarProElm::validate() const {
  layer().validate("VarProElm");
  demand(ridge > 0 && ridge < 1, "VarProElm: ridge is ", ridge, ", must lie in (0, 1)");
  demand(iterations >= 0, "VarProElm: iterations is ", iterations, ", must not be negative");
  demand(tolerance >= 0 && tolerance < 1, "VarProElm: tolerance is ", tolerance, ", must lie in [0, 1)");
  demand(starts >= 1, "VarProElm: starts is ", starts, ", must be at least 1");
}

VERNIER_IMPL detail::VarProTrainingError VarProElm::training_error(const ConstMatrixRef& inputs,
                                                                   const ConstMatrixRef& targets,
                                                                   const VectorX* weights) const {
  const MatrixX mapped = layer().map(inputs);
  return {layer(), layer().scaling(mapped).apply(mapped), detail::CommonScaling(targets, weights).apply(targets), ridge,
          weights};
}

VERNIER_IMPL detail::FittedNetwork VarProElm::train(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                    const VectorX* theta, const FitOptions& options) const {
  const int n = static_cast<int>(inputs.cols()), count = theta != nullptr ? 1 : starts;
  demand(theta == nullptr || theta->size() == dimension(n), "VarProElm: ", theta != nullptr ? theta->size() : 0,
         " hidden weights, expected ", dimension(n));
  const auto seed_of = [&](int start) {
    return start == 0 ? options.seed : child_seed(options.seed, static_cast<std::uint64_t>(start));
  };
  const MatrixX mapped = layer().map(inputs);
  const ColumnScaling in = layer().scaling(mapped);
  const detail::CommonScaling out(targets, options.weights);
  detail::VariableProjection projection(layer(), in.apply(mapped), out.apply(targets), ridge, options.weights);
  VectorX best;
  double least = std::numeric_limits<double>::infinity();
  Progress progress{-1, 0, least};
  bool go_on = true;
  for (int start = 0; go_on && start < count; ++start) {
    VectorX hidden = theta != nullptr ? *theta : layer().draw(n, seed_of(start));
    const double value =
        detail::levenberg_marquardt(projection, hidden, iterations, tolerance, options.executor, [&](double so_far) {
          ++progress.generation;
          ++progress.evaluations;
          progress.best = (std::min)(least, so_far);
          return go_on = options.observer(progress);
        });
    if (value < least) {
      least = value;
      best = hidden;
    }
  }
  demand(std::isfinite(least), "VarProElm: the hidden layer is not finite at the weights to start from");
  projection.evaluate(best);  // the last step tried may have been another one
  return {layer(), in, best, out.spread * projection.beta(), out.mean + out.spread * projection.offset()};
}

}  // namespace vernier
