// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "vernier/core/detail/dense.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/regression/back_propagation.hpp"
#include "vernier/regression/detail/common_scaling.hpp"
#include "vernier/regression/detail/levenberg_marquardt.hpp"
#include "vernier/regression/detail/network_error.hpp"

namespace vernier {

namespace detail {

/// Steps of Adam on a `NetworkError`.
/// @param theta where to start; then the last weights
/// @param watch `bool(double value)`, called with the objective for the start and after every epoch; false ends it
VERNIER_LOCAL void train_by_adam(NetworkError& problem, VectorX& theta, const Adam& adam, std::uint64_t seed,
                                 FunctionRef<bool(double value)> watch) {
  Rng rng(seed);
  VectorX gradient, roots, mean = VectorX::Zero(theta.size()), square = mean;
  double mean_bias = 1, square_bias = 1;
  const Index n = problem.samples(), batch = std::min<Index>(adam.batch, n), batches = (n + batch - 1) / batch;
  const double steps = static_cast<double>(adam.epochs) * static_cast<double>(batches);
  double step = 0;
  bool go_on = watch(problem.evaluate(theta));
  for (int epoch = 0; go_on && epoch < adam.epochs; ++epoch) {
    const std::vector<Index> order = rng.permutation(n);
    for (Index b = 0; b < batches; ++b, ++step) {
      const std::vector<Index> rows(order.begin() + n * b / batches, order.begin() + n * (b + 1) / batches);
      problem.batch(theta, rows, gradient);
      for (Index k = 0; k < theta.size(); ++k) {
        mean(k) = adam.momentum * mean(k) + (1 - adam.momentum) * gradient(k);
        square(k) = adam.memory * square(k) + (1 - adam.memory) * gradient(k) * gradient(k);
      }
      roots = VERNIER_LATER(square).cwiseSqrt();
      mean_bias *= adam.momentum;
      square_bias *= adam.memory;
      const double rate = adam.learning_rate * (0.5 + 0.5 * std::cos(3.14159265358979323846 * step / steps));
      const double root_bias = std::sqrt(1 - square_bias), factor = rate * root_bias / (1 - mean_bias);
      for (Index k = 0; k < theta.size(); ++k) theta(k) -= factor * mean(k) / (roots(k) + 1e-8 * root_bias);
    }
    go_on = watch(problem.evaluate(theta));
  }
}

}  // namespace detail

VERNIER_IMPL void BackPropagation::validate() const {
  layer().validate("BackPropagation");
  demand(activation == Activation::sigmoid || activation == Activation::tanh,
         "BackPropagation: activation must be sigmoid or tanh");
  demand(weight_decay >= 0 && weight_decay < 1, "BackPropagation: weight_decay is ", weight_decay,
         ", must lie in [0, 1)");
  demand(validation_share >= 0 && validation_share < 1, "BackPropagation: validation_share is ", validation_share,
         ", must lie in [0, 1)");
  demand(patience >= 1, "BackPropagation: patience is ", patience, ", must be at least 1");
  if (const auto* adam = std::get_if<Adam>(&training)) {
    demand(adam->epochs >= 0, "Adam: epochs is ", adam->epochs, ", must not be negative");
    demand(adam->batch >= 1, "Adam: batch is ", adam->batch, ", must be at least 1");
    demand(adam->learning_rate > 0 && adam->learning_rate < 1, "Adam: learning_rate is ", adam->learning_rate,
           ", must lie in (0, 1)");
    demand(adam->momentum >= 0 && adam->momentum < 1, "Adam: momentum is ", adam->momentum, ", must lie in [0, 1)");
    demand(adam->memory >= 0 && adam->memory < 1, "Adam: memory is ", adam->memory, ", must lie in [0, 1)");
  } else {
    const auto& lm = std::get<LevenbergMarquardt>(training);
    demand(lm.epochs >= 0, "LevenbergMarquardt: epochs is ", lm.epochs, ", must not be negative");
    demand(lm.tolerance >= 0 && lm.tolerance < 1, "LevenbergMarquardt: tolerance is ", lm.tolerance,
           ", must lie in [0, 1)");
  }
}

VERNIER_IMPL detail::FittedNetwork BackPropagation::train(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                          const FitOptions& options) const {
  const Index n = inputs.rows(), m = targets.cols();
  const VectorX weights = detail::weights_or_ones(options.weights, n);
  const MatrixX mapped = layer().map(inputs);
  const ColumnScaling in = layer().scaling(mapped);
  const detail::CommonScaling out(targets, options.weights);
  const MatrixX features = in.apply(mapped), scaled = out.apply(targets);

  std::vector<Index> kept = Rng(child_seed(options.seed, 1)).permutation(n);
  const auto cut = kept.begin() + (std::min)(n - 1, static_cast<Index>(validation_share * static_cast<double>(n)));
  std::vector<Index> held_out(kept.begin(), cut);
  kept.erase(kept.begin(), cut);
  if (held_out.empty()) std::sort(kept.begin(), kept.end());
  const auto part = [&](const std::vector<Index>& rows, double decay) -> detail::NetworkError {
    return {layer(), detail::rows_of(features, rows), detail::rows_of(scaled, rows), detail::rows_of(weights, rows),
            decay};
  };
  detail::NetworkError problem = part(kept, weight_decay), validation = part(held_out.empty() ? kept : held_out, 0);

  VectorX theta(problem.dimension()), best;
  VERNIER_LATER(theta).head(problem.hidden()) = layer().draw(static_cast<int>(inputs.cols()), options.seed);
  Rng rng(child_seed(options.seed, 0));
  for (Index k = problem.hidden(); k < theta.size(); ++k) theta(k) = rng.uniform(-1, 1) / hidden_nodes;
  double least = std::numeric_limits<double>::infinity(), lowest = least;
  Index epoch = -1, best_epoch = 0;
  const auto watch = [&](double objective) {
    ++epoch;
    lowest = (std::min)(lowest, objective);
    const double error = held_out.empty() ? objective : validation.evaluate(theta);
    if (error < least) {
      least = error;
      best = theta;
      best_epoch = epoch;
    }
    return options.observer(Progress{epoch, epoch + 1, lowest}) && (held_out.empty() || epoch - best_epoch < patience);
  };
  if (const auto* adam = std::get_if<Adam>(&training)) {
    detail::train_by_adam(problem, theta, *adam, child_seed(options.seed, 2), watch);
  } else {
    const auto& lm = std::get<LevenbergMarquardt>(training);
    detail::levenberg_marquardt(problem, theta, lm.epochs, lm.tolerance, options.executor, watch);
  }
  demand(best.size() > 0, "BackPropagation: the network is not finite at the weights to start from");
  MatrixX beta(hidden_nodes, m);
  VectorX offset = out.mean;
  for (Index o = 0, k = problem.hidden(); o < m; ++o) {
    for (Index node = 0; node < hidden_nodes; ++node) beta(node, o) = out.spread * best(k++);
    offset(o) += out.spread * best(k++);
  }
  return {layer(), in, VERNIER_LATER(best).head(problem.hidden()), beta, offset};
}

}  // namespace vernier
