#pragma once

/// @file
/// The classical network: one hidden layer, all weights trained by gradients.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "vernier/regression/elm_predictor.hpp"
#include "vernier/regression/network_error.hpp"
#include "vernier/regression/var_pro_elm.hpp"

namespace vernier {

/// Training by damped Gauss-Newton steps on all weights and all samples.
/// @cite Hagan and Menhaj 1994; Marquardt 1963
struct LevenbergMarquardt {
  int epochs = 100;         ///< steps tried, 0 or more
  double tolerance = 1e-4;  ///< ten steps that together lower the objective by less than this share end the training
};

/// Training by gradients of mini-batches, each weight with a step of its own. The batches are drawn anew for every
/// epoch, from the seed; the learning rate falls to zero as half a cosine.
/// @cite Kingma and Ba 2015; Loshchilov and Hutter 2017 (the cosine)
struct Adam {
  int epochs = 500;             ///< passes over all samples, 0 or more
  int batch = 100;              ///< samples of a step, at least 1
  double learning_rate = 0.01;  ///< at the start; in (0, 1)
  double momentum = 0.9;        ///< share that the mean gradient keeps in a step, in [0, 1)
  double memory = 0.999;        ///< share that the mean squared gradient keeps in a step, in [0, 1)
};

namespace detail {

/// Steps of Adam on a `NetworkError`.
/// @param theta where to start; then the last weights
/// @param watch `bool(double value)`, called with the objective for the start and after every epoch; false ends it
template <class Watch>
void train(NetworkError& problem, VectorX& theta, const Adam& adam, std::uint64_t seed, Watch&& watch) {
  Rng rng(seed);
  VectorX gradient, mean = VectorX::Zero(theta.size()), square = mean;
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
      mean = adam.momentum * mean + (1 - adam.momentum) * gradient;
      square = adam.memory * square + (1 - adam.memory) * gradient.cwiseAbs2();
      mean_bias *= adam.momentum;
      square_bias *= adam.memory;
      const double rate = adam.learning_rate * (0.5 + 0.5 * std::cos(3.14159265358979323846 * step / steps));
      theta.array() -= rate / (1 - mean_bias) * mean.array() / ((square.array() / (1 - square_bias)).sqrt() + 1e-8);
    }
    go_on = watch(problem.evaluate(theta));
  }
}

}  // namespace detail

/// The classical back-propagation network: one hidden layer of sigmoid or tanh nodes, linear outputs, all weights
/// trained from a random start. The weights of the epoch with the least error are kept: of the validation samples where
/// there are some, else of those trained on. Where thousands of samples call for a network, `VarProElm` has the output
/// weights at their best throughout and needs fewer steps.
/// @complexity an epoch of Levenberg-Marquardt sums up n nodes^2 (features + 1)^2 / 4 products and solves for all
/// weights; one of Adam takes n nodes (features + outputs) multiply-adds, six times
/// @cite Rumelhart 1986
struct BackPropagation {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes: sigmoid or tanh.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  double weight_limit = 1;                   ///< hidden weights and biases start in [-limit, limit]
  double weight_decay = 1e-9;  ///< of all weights but biases, per sample, for targets of unit spread; in [0, 1)
  /// How.
  std::variant<LevenbergMarquardt, Adam> training = LevenbergMarquardt{};
  double validation_share = 0;  ///< of the samples, drawn from the seed, not trained on but judged by; in [0, 1)
  int patience = 20;            ///< epochs without a lower validation error that end the training, at least 1

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Training from a start drawn from the seed. The observer sees the objective before the first epoch and after each:
  /// the weighted mean squared error of what is trained on, in units of the targets' spread, and the decay.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options a sample of weight q counts as q samples, but that Adam's batches and the validation samples are
  ///                drawn from the rows
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    validate();
    detail::require_samples("BackPropagation", inputs, targets, options);
    const Index n = inputs.rows(), m = targets.cols();
    const VectorX weights = detail::weights_or_ones(options.weights, n);
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling in = layer().scaling(mapped);
    const detail::CommonScaling out(targets, options.weights);
    const MatrixX features = in.apply(mapped), scaled = out.apply(targets);

    std::vector<Index> kept = Rng(child_seed(options.seed, 1)).permutation(n);
    const auto cut = kept.begin() + std::min(n - 1, static_cast<Index>(validation_share * static_cast<double>(n)));
    std::vector<Index> judged(kept.begin(), cut);
    kept.erase(kept.begin(), cut);
    if (judged.empty()) std::sort(kept.begin(), kept.end());
    const auto part = [&](const std::vector<Index>& rows, double decay) -> detail::NetworkError {
      return {layer(), features(rows, Eigen::all), scaled(rows, Eigen::all), weights(rows), decay};
    };
    detail::NetworkError problem = part(kept, weight_decay), judge = part(judged.empty() ? kept : judged, 0);

    VectorX theta(problem.dimension()), best;
    theta.head(problem.hidden()) = layer().draw(X::ColsAtCompileTime, options.seed);
    Rng rng(child_seed(options.seed, 0));
    for (double& weight : theta.tail((hidden_nodes + 1) * m)) weight = rng.uniform(-1, 1) / hidden_nodes;
    double least = std::numeric_limits<double>::infinity(), lowest = least;
    Index epoch = -1, best_epoch = 0;
    const auto watch = [&](double objective) {
      ++epoch;
      lowest = std::min(lowest, objective);
      const double error = judged.empty() ? objective : judge.evaluate(theta);
      if (error < least) {
        least = error;
        best = theta;
        best_epoch = epoch;
      }
      return options.observer(Progress{epoch, epoch + 1, lowest}) && (judged.empty() || epoch - best_epoch < patience);
    };
    if (const auto* adam = std::get_if<Adam>(&training)) {
      detail::train(problem, theta, *adam, child_seed(options.seed, 2), watch);
    } else {
      const auto& lm = std::get<LevenbergMarquardt>(training);
      detail::levenberg_marquardt(problem, theta, lm.epochs, lm.tolerance, options.executor, watch);
    }
    require(best.size() > 0, "BackPropagation: the network is not finite at the weights to start from");
    const MatrixX beta = best.tail((hidden_nodes + 1) * m).reshaped(hidden_nodes + 1, m);
    return {layer(), in, best.head(problem.hidden()), out.spread * beta.topRows(hidden_nodes),
            out.mean + out.spread * beta.row(hidden_nodes).transpose()};
  }

 private:
  void validate() const {
    layer().validate("BackPropagation");
    require(activation == Activation::sigmoid || activation == Activation::tanh,
            "BackPropagation: activation must be sigmoid or tanh");
    require(weight_decay >= 0 && weight_decay < 1, "BackPropagation: weight_decay is ", weight_decay,
            ", must lie in [0, 1)");
    require(validation_share >= 0 && validation_share < 1, "BackPropagation: validation_share is ", validation_share,
            ", must lie in [0, 1)");
    require(patience >= 1, "BackPropagation: patience is ", patience, ", must be at least 1");
    if (const auto* adam = std::get_if<Adam>(&training)) {
      require(adam->epochs >= 0, "Adam: epochs is ", adam->epochs, ", must not be negative");
      require(adam->batch >= 1, "Adam: batch is ", adam->batch, ", must be at least 1");
      require(adam->learning_rate > 0 && adam->learning_rate < 1, "Adam: learning_rate is ", adam->learning_rate,
              ", must lie in (0, 1)");
      require(adam->momentum >= 0 && adam->momentum < 1, "Adam: momentum is ", adam->momentum, ", must lie in [0, 1)");
      require(adam->memory >= 0 && adam->memory < 1, "Adam: memory is ", adam->memory, ", must lie in [0, 1)");
    } else {
      const auto& lm = std::get<LevenbergMarquardt>(training);
      require(lm.epochs >= 0, "LevenbergMarquardt: epochs is ", lm.epochs, ", must not be negative");
      require(lm.tolerance >= 0 && lm.tolerance < 1, "LevenbergMarquardt: tolerance is ", lm.tolerance,
              ", must lie in [0, 1)");
    }
  }
};

}  // namespace vernier
