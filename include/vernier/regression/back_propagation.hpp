// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The classical network: one hidden layer, all weights trained by gradients.

#include <variant>

#include "vernier/regression/elm_predictor.hpp"

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
  /// Features of the inputs.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of the features, see `HiddenLayer`
  double weight_limit = 1;                   ///< hidden weights and biases start in [-limit, limit]
  double weight_decay = 1e-9;  ///< of all weights but biases, per sample, for targets of unit spread; in [0, 1)
  /// The algorithm.
  std::variant<LevenbergMarquardt, Adam> training = LevenbergMarquardt{};
  double validation_share =
      0;              ///< of the samples, drawn from the seed, used for validation instead of training; in [0, 1)
  int patience = 20;  ///< epochs without a lower validation error that end the training, at least 1

  /// The hidden layer.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// Training from a start drawn from the seed. The observer is called with the objective before the first epoch and
  /// after each: the weighted mean squared error of the training samples, in units of the targets' spread, and the
  /// decay.
  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options a sample of weight q counts as q samples, but that Adam's batches and the validation samples are
  ///                drawn from the rows
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                    const FitOptions& options = {}) const {
    validate();
    detail::require_samples("BackPropagation", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(train(inputs.derived(), targets.derived(), options));
  }

 private:
  VERNIER_API void validate() const;
  VERNIER_API detail::FittedNetwork train(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/back_propagation.ipp"
#endif
