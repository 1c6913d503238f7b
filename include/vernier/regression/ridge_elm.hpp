#pragma once

/// @file
/// Extreme learning machine with a ridge on the output weights, chosen by closed-form leave-one-out.

#include <limits>
#include <optional>

#include "vernier/regression/elm_predictor.hpp"
#include "vernier/regression/least_squares.hpp"
#include "vernier/regression/leave_one_out.hpp"

namespace vernier {

namespace detail {

/// Fitness of hidden weights by leave-one-out error at the best ridge, the mean alone among the candidates.
class RidgeElmLeaveOneOutError {
 public:
  RidgeElmLeaveOneOutError(const HiddenLayer& layer, MatrixX features, MatrixX targets, const VectorX* weights)
      : layer_(layer), features_(std::move(features)), targets_(std::move(targets)) {
    if (weights != nullptr) weights_ = *weights;
  }

  template <class Population, class Fitness>
  void operator()(const Eigen::MatrixBase<Population>& population, Fitness&& fitness) const {
    std::optional<LeaveOneOutError> products;
    const VectorX* weights = weights_.size() > 0 ? &weights_ : nullptr;
    if (weights == nullptr && LeaveOneOutError::supports(layer_, targets_.rows()))
      products.emplace(layer_, features_, targets_);
    MatrixX h;
    for (Index k = 0; k < population.cols(); ++k) {
      fitness(k) = products ? (*products)(population.col(k)) : -1;
      if (fitness(k) >= 0) continue;  // else the products do not tell: singular values do
      layer_.outputs(features_, population.col(k), h);
      fitness(k) = h.allFinite() ? choose_lambda(RidgePath(h, targets_, weights), targets_.rows()).mean_squared_error
                                 : std::numeric_limits<double>::infinity();
    }
  }

 private:
  HiddenLayer layer_;
  MatrixX features_, targets_;
  VectorX weights_;  // empty: all the same
};

}  // namespace detail

/// Ridge ELM: the mean of the targets is not penalised, lambda has the least leave-one-out error, and where nothing can
/// be learned the mean alone wins. Targets keep their units, so outputs weigh as they are.
/// @cite Huang 2012; Allen 1974
struct RidgeElm {
  int hidden_nodes = 65;  ///< at least 1; may exceed the number of samples
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// What the layer sees of each input.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of raw inputs
  double evidence = 3;      ///< standard errors by which leave-one-out must beat the mean alone, or the mean is kept: a
                            ///< search over many layers finds one that seems a little better by chance
  double weight_limit = 1;  ///< hidden weights and biases lie in [-limit, limit]

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Length of the vector of hidden weights that a search moves.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Where a search looks.
  Box box(int inputs) const { return layer().box(inputs); }

  /// Leave-one-out mean squared error of hidden weights, in squared units of the targets.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::RidgeElmLeaveOneOutError objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                             const VectorX* weights = nullptr) const {
    validate(inputs, targets, {.weights = weights});
    const MatrixX mapped = layer().map(inputs);
    return {layer(), layer().scaling(mapped).apply(mapped), targets, weights};
  }

  /// Fit with given hidden weights.
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
    require(theta.size() == dimension(X::ColsAtCompileTime), "RidgeElm: ", theta.size(), " hidden weights, expected ",
            dimension(X::ColsAtCompileTime));
    const MatrixX mapped = layer().map(inputs);
    const ColumnScaling in = layer().scaling(mapped);
    MatrixX h;
    layer().outputs(in.apply(mapped), theta, h);
    const RidgePath path(h, targets, options.weights);
    double lambda = choose_lambda(path, h.rows()).lambda;
    if (evidence_against_mean(path, lambda, h.rows()) < evidence) lambda = std::numeric_limits<double>::infinity();
    const MatrixX beta = path.beta(lambda);
    return {layer(), in, theta, beta, path.offset(beta)};
  }

  /// Fit with hidden weights drawn from the seed.
  template <class X, class Y>
  ElmPredictor<X::ColsAtCompileTime, Y::ColsAtCompileTime> fit(const Eigen::MatrixBase<X>& inputs,
                                                               const Eigen::MatrixBase<Y>& targets,
                                                               const FitOptions& options = {}) const {
    layer().validate("RidgeElm");
    return fit_at(inputs, targets, layer().draw(X::ColsAtCompileTime, options.seed), options);
  }

 private:
  template <class X, class Y>
  void validate(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                const FitOptions& options) const {
    layer().validate("RidgeElm");
    detail::require_samples("RidgeElm", inputs, targets, options);
  }
};

}  // namespace vernier
