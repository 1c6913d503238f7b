// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The extreme learning machine: a hidden layer of random or tuned weights, output weights by least squares.

#include "vernier/regression/detail/elm_fitness.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Extreme learning machine. `fit` draws the hidden weights from the seed; `Tuned` searches for them.
/// @cite Huang 2006; Feng, Dong, Jin (as a robot's error model)
struct Elm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs.
  InputMap input_map = InputMap::raw;
  /// Of the features, fitted on the samples; see `HiddenLayer`.
  Scaling input_scaling = Scaling::min_max;
  /// Of the targets, fitted on the samples.
  Scaling target_scaling = Scaling::min_max;
  double weight_limit = 1;  ///< hidden weights and biases lie in [-limit, limit]
  double rcond = 1e-12;     ///< singular values of H below this times the largest count as zero

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Number of hidden weights and biases: the dimension of a search.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Domain of a search.
  VERNIER_API Box box(int inputs) const;

  /// Error of hidden weights in scaled targets, per sample: what the paper minimises,
  /// `|H beta - T|^2 + lambda |beta|^2` at its minimum over beta, divided by n.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::ElmFitness objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                               const VectorX* weights = nullptr) const {
    validate();
    detail::require_samples("Elm", inputs, targets, {.weights = weights});
    return fitness(inputs.derived(), targets.derived(), weights);
  }

  /// Fit with given hidden weights: minimum-norm output weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  /// @param options sample weights; nothing else matters here
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit_at(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                       const VectorX& theta, const FitOptions& options = {}) const {
    validate();
    detail::require_samples("Elm", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(solve(inputs.derived(), targets.derived(), theta, options));
  }

  /// Fit with hidden weights drawn from the seed.
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                    const FitOptions& options = {}) const {
    validate();
    return fit_at(inputs, targets, layer().draw(X::ColsAtCompileTime, options.seed), options);
  }

 private:
  friend struct detail::RunTimeFit;

  VERNIER_API void validate() const;
  VERNIER_API detail::ElmFitness fitness(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                         const VectorX* weights) const;
  VERNIER_API detail::FittedNetwork solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const VectorX& theta, const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/elm.ipp"
#endif
