// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// An extreme learning machine whose hidden layer is trained by gradients: variable projection.

#include "vernier/regression/detail/var_pro_training_error.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Extreme learning machine with a trained hidden layer. The output weights are always the best ones for the hidden
/// layer, so the training error is a function of the hidden weights alone, and Levenberg-Marquardt lowers it: seconds,
/// where a population search takes minutes and ends higher. Minimises the training error: give it thousands of samples,
/// or `RidgeElm` few. The mean of the targets is not penalised; targets keep their units, so outputs weigh as they are.
/// `Tuned{VarProElm{}, Pso{}}` lets a search choose where the training starts.
/// @complexity an iteration sums up n nodes^2 (features + 1)^2 / 4 products and solves for nodes (features + 1) weights
/// @cite Golub and Pereyra 1973; Kaufman 1975
struct VarProElm {
  int hidden_nodes = 65;  ///< at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of the features, see `HiddenLayer`
  double weight_limit = 1;  ///< hidden weights and biases start in [-limit, limit]; training may leave it
  double ridge = 1e-10;     ///< of the output weights, for targets of unit spread, per sample; in (0, 1)
  int iterations = 100;     ///< steps tried from each start; 0: the hidden layer as it is drawn
  double tolerance = 1e-4;  ///< ten steps that together lower the objective by less than this share end the training
  int starts = 1;           ///< hidden layers drawn and trained; the best is kept

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Number of hidden weights and biases: the dimension of a search.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Domain of a search for a start.
  VERNIER_API Box box(int inputs) const;

  /// The objective of the training as a function of hidden weights: `|H beta + C - T|^2 / n + ridge |beta|^2` at its
  /// minimum over beta and C, whose rows are equal, T being the targets in units of their spread; the mean alone has 1.
  /// Its member `gradient(theta)` is the exact gradient.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::VarProTrainingError objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                        const VectorX* weights = nullptr) const {
    validate();
    detail::require_samples("VarProElm", inputs, targets, {.weights = weights});
    return training_error(inputs.derived(), targets.derived(), weights);
  }

  /// Training that starts from given hidden weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  /// @param options weights, executor, and observer, which is called with the best objective after every step
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit_at(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                       const VectorX& theta, const FitOptions& options = {}) const {
    validate();
    detail::require_samples("VarProElm", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(train(inputs.derived(), targets.derived(), &theta, options));
  }

  /// Training that starts from hidden weights drawn from the seed. The first start is what `Elm` draws.
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                    const FitOptions& options = {}) const {
    validate();
    detail::require_samples("VarProElm", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(train(inputs.derived(), targets.derived(), nullptr, options));
  }

 private:
  friend struct detail::RunTimeFit;

  VERNIER_API void validate() const;
  VERNIER_API detail::VarProTrainingError training_error(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                                         const VectorX* weights) const;
  /// @param theta where to start; null: drawn, `starts` times
  VERNIER_API detail::FittedNetwork train(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const VectorX* theta, const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/var_pro_elm.ipp"
#endif
