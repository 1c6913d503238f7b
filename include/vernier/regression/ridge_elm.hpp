// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Extreme learning machine with a ridge on the output weights, chosen by closed-form leave-one-out.

#include "vernier/regression/detail/ridge_elm_leave_one_out.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Ridge ELM: the mean of the targets is not penalised, lambda has the least leave-one-out error, and where that is
/// not significantly better than the mean alone, the mean is kept. Targets keep their units, so outputs weigh as they
/// are.
/// @cite Huang 2012; Allen 1974
struct RidgeElm {
  int hidden_nodes = 65;  ///< at least 1; may exceed the number of samples
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of the features, see `HiddenLayer`
  double weight_limit = 1;                   ///< hidden weights and biases lie in [-limit, limit]

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Number of hidden weights and biases: the dimension of a search.
  Index dimension(int inputs) const { return layer().dimension(inputs); }
  /// Domain of a search.
  VERNIER_API Box box(int inputs) const;

  /// Leave-one-out mean squared error of hidden weights, in squared units of the targets.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param weights of the samples; null: all the same
  template <class X, class Y>
  detail::RidgeElmLeaveOneOutError objective(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                             const VectorX* weights = nullptr) const {
    layer().validate("RidgeElm");
    detail::require_samples("RidgeElm", inputs, targets, {.weights = weights});
    return leave_one_out_error(inputs.derived(), targets.derived(), weights);
  }

  /// Fit with given hidden weights.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param theta   `dimension(inputs)` weights, node by node
  /// @param options sample weights; nothing else matters here
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit_at(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                       const VectorX& theta, const FitOptions& options = {}) const {
    layer().validate("RidgeElm");
    detail::require_samples("RidgeElm", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(solve(inputs.derived(), targets.derived(), theta, options));
  }

  /// Fit with hidden weights drawn from the seed.
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                    const FitOptions& options = {}) const {
    layer().validate("RidgeElm");
    return fit_at(inputs, targets, layer().draw(X::ColsAtCompileTime, options.seed), options);
  }

 private:
  friend struct detail::RunTimeFit;

  VERNIER_API detail::RidgeElmLeaveOneOutError leave_one_out_error(const ConstMatrixRef& inputs,
                                                                   const ConstMatrixRef& targets,
                                                                   const VectorX* weights) const;
  VERNIER_API detail::FittedNetwork solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const VectorX& theta, const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/ridge_elm.ipp"
#endif
