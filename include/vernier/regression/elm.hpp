#pragma once

/// @file
/// The extreme learning machine: a hidden layer of random or tuned weights, output weights by least squares.

#include "vernier/regression/elm_predictor.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/normal_equations.hpp"

namespace vernier {

namespace detail {

/// Fitness of hidden weights by the regularised training error; columns of a population are independent.
class ElmTrainingError {
 public:
  ElmTrainingError(const HiddenLayer& layer, MatrixX features, MatrixX targets, double relative_lambda)
      : layer_(layer),
        features_(std::move(features)),
        targets_(std::move(targets)),
        relative_lambda_(relative_lambda) {}

  /// @param population dimension x particles
  /// @param fitness    one value a particle
  template <class Population, class Fitness>
  void operator()(const Eigen::MatrixBase<Population>& population, Fitness&& fitness) const {
    const double samples = static_cast<double>(targets_.rows());
    NormalEquations equations(layer_, features_, targets_);
    MatrixX h;
    for (Index k = 0; k < population.cols(); ++k) {
      double objective = -1;
      if (NormalEquations::supports(layer_.activation)) {
        equations.form(population.col(k));
        objective =
            relative_ridge_objective(equations.gram(), equations.right(), equations.target_square(), relative_lambda_);
      }
      if (!(objective >= 0)) {  // too nearly perfect or too badly conditioned to be told from the products
        layer_.outputs(features_, population.col(k), h);
        objective = relative_ridge(h, targets_, relative_lambda_).objective;
      }
      fitness(k) = objective / samples;
    }
  }

 private:
  HiddenLayer layer_;
  MatrixX features_, targets_;
  double relative_lambda_;
};

}  // namespace detail

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

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Length of the vector of hidden weights that a search moves.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Where a search looks.
  Box box(int inputs) const { return layer().box(inputs); }

  /// Training error of hidden weights in scaled targets, per sample: what the paper minimises.
  /// `|H beta - T|^2 + lambda |beta|^2` at its minimum over beta, divided by n.
  template <class X, class Y>
  detail::ElmTrainingError objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets) const {
    validate(inputs, targets);
    require(fitness_lambda > 0 && fitness_lambda < 1, "Elm: fitness_lambda is ", fitness_lambda,
            ", must lie in (0, 1)");
    const MatrixX mapped = layer().map(inputs);
    return {layer(), layer().scaling(mapped).apply(mapped), ColumnScaling::fit(targets, target_scaling).apply(targets),
            fitness_lambda};
  }

  /// Fit with given hidden weights: minimum-norm output weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit_at(const Eigen::MatrixBase<X>& inputs,
                                                                  const Eigen::MatrixBase<Y>& targets,
                                                                  const VectorX& theta) const {
    validate(inputs, targets);
    require(theta.size() == dimension(X::ColsAtCompileTime), "Elm: ", theta.size(), " hidden weights, expected ",
            dimension(X::ColsAtCompileTime));
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling in = layer().scaling(mapped), out = ColumnScaling::fit(targets, target_scaling);
    MatrixX h;
    layer().outputs(in.apply(mapped), theta, h);
    const MatrixX beta = minimum_norm_solution(h, out.apply(targets), rcond) * out.factor.cwiseInverse().asDiagonal();
    return {layer(), in, theta, beta, out.offset};
  }

  /// Fit with hidden weights drawn from the seed.
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    layer().validate("Elm");
    return fit_at(inputs, targets, layer().draw(X::ColsAtCompileTime, options.seed));
  }

 private:
  template <class X, class Y>
  void validate(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets) const {
    layer().validate("Elm");
    require(rcond >= 0 && rcond < 1, "Elm: rcond is ", rcond, ", must lie in [0, 1)");
    detail::require_samples("Elm", inputs, targets);
  }
};

}  // namespace vernier
