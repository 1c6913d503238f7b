#pragma once

/// @file
/// The extreme learning machine: a hidden layer of random or tuned weights, output weights by least squares.

#include "vernier/regression/elm_fitness.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Extreme learning machine. `fit` draws the hidden weights from the seed; `Tuned` searches for them.
/// @cite Huang 2006; Feng, Dong, Jin (as a robot's error model)
struct Elm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::raw;
  /// Of raw inputs, fitted on the samples.
  Scaling input_scaling = Scaling::min_max;
  /// Of the targets, fitted on the samples.
  Scaling target_scaling = Scaling::min_max;
  double weight_limit = 1;        ///< hidden weights and biases lie in [-limit, limit]
  double rcond = 1e-12;           ///< singular values of H below this times the largest count as zero
  double fitness_lambda = 1e-10;  ///< ridge of the fitness alone, relative to tr(H'H) / nodes; the fit has none
  int hold_out_every = 0;  ///< where a search judges by samples held out: each so-manieth one, at least 2; 0: by the
                           ///< training error. The fit has all samples.

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Length of the vector of hidden weights that a search moves.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Where a search looks.
  Box box(int inputs) const { return layer().box(inputs); }

  /// Error of hidden weights in scaled targets, per sample: what the paper minimises,
  /// `|H beta - T|^2 + lambda |beta|^2` at its minimum over beta, divided by n; or that of the samples held out.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::ElmFitness objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                               const VectorX* weights = nullptr) const {
    validate(inputs, targets, {.weights = weights});
    require(fitness_lambda > 0 && fitness_lambda < 1, "Elm: fitness_lambda is ", fitness_lambda,
            ", must lie in (0, 1)");
    require(hold_out_every == 0 || (hold_out_every >= 2 && hold_out_every <= inputs.rows()), "Elm: hold_out_every is ",
            hold_out_every, ", must be 0 or lie in 2..", inputs.rows(), ", the samples");
    const MatrixX mapped = layer().map(inputs);
    return {layer(),
            layer().scaling(mapped).apply(mapped),
            ColumnScaling::fit(targets, target_scaling).apply(targets),
            fitness_lambda,
            hold_out_every,
            weights};
  }

  /// Fit with given hidden weights: minimum-norm output weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  /// @param options sample weights; nothing else matters here
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit_at(const Eigen::MatrixBase<X>& inputs,
                                                                  const Eigen::MatrixBase<Y>& targets,
                                                                  const VectorX& theta,
                                                                  const FitOptions& options = {}) const {
    validate(inputs, targets, options);
    require(theta.size() == dimension(X::ColsAtCompileTime), "Elm: ", theta.size(), " hidden weights, expected ",
            dimension(X::ColsAtCompileTime));
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling in = layer().scaling(mapped), out = ColumnScaling::fit(targets, target_scaling);
    MatrixX h, t = out.apply(targets);
    layer().outputs(in.apply(mapped), theta, h);
    if (options.weights != nullptr) {
      const VectorX roots = options.weights->cwiseSqrt();
      h = roots.asDiagonal() * h;
      t = roots.asDiagonal() * t;
    }
    const MatrixX beta = minimum_norm_solution(h, t, rcond) * out.factor.cwiseInverse().asDiagonal();
    return {layer(), in, theta, beta, out.offset};
  }

  /// Fit with hidden weights drawn from the seed.
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    layer().validate("Elm");
    return fit_at(inputs, targets, layer().draw(X::ColsAtCompileTime, options.seed), options);
  }

 private:
  template <class X, class Y>
  void validate(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                const FitOptions& options) const {
    layer().validate("Elm");
    require(rcond >= 0 && rcond < 1, "Elm: rcond is ", rcond, ", must lie in [0, 1)");
    detail::require_samples("Elm", inputs, targets, options);
  }
};

}  // namespace vernier
