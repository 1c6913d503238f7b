// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The optimally pruned extreme learning machine: the number of nodes is chosen by leave-one-out.

#include "vernier/regression/elm_predictor.hpp"

namespace vernier {

/// Optimally pruned ELM. Of `hidden_nodes` random nodes those are kept, in the order of orthogonal forward selection,
/// that give the least leave-one-out error (PRESS) of a least-squares fit; none is a candidate. Targets keep their
/// units, so outputs weigh as they are; the mean is not penalised. Miche ranks by multi-response sparse regression;
/// forward selection also takes all outputs at once, lowers the error that PRESS estimates and yields PRESS of every
/// number of nodes. As the ranking uses all samples, the PRESS of the selected nodes is slightly optimistic.
/// O(n nodes^2).
/// @cite Miche 2010; Chen, Cowan and Grant 1991
struct OpElm {
  int hidden_nodes = 100;  ///< candidates, at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs.
  InputMap input_map = InputMap::sines_and_cosines;
  Scaling input_scaling = Scaling::min_max;  ///< of the features, see `HiddenLayer`
  double weight_limit = 1;                   ///< hidden weights and biases lie in [-limit, limit]

  /// The hidden layer of all candidates.
  HiddenLayer layer() const { return {hidden_nodes, activation, input_map, input_scaling, weight_limit}; }

  /// @param inputs  n x inputs
  /// @param targets n x outputs
  /// @param options the seed draws the candidates; a sample of weight w counts as w in the fit, and is left out whole
  /// @return        the nodes that are left; where none is, one whose output weights are zero
  /// @throws std::invalid_argument for unusable samples, weights or options
  template <class X, class Y>
  detail::ElmPredictorFor<X, Y> fit(const Eigen::MatrixBase<X>& inputs, const Eigen::MatrixBase<Y>& targets,
                                    const FitOptions& options = {}) const {
    layer().validate("OpElm");
    detail::require_samples("OpElm", inputs, targets, options);
    return detail::ElmPredictorFor<X, Y>(solve(inputs.derived(), targets.derived(), options));
  }

 private:
  VERNIER_API detail::FittedNetwork solve(const ConstMatrixRef& inputs, const ConstMatrixRef& targets,
                                          const FitOptions& options) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/op_elm.ipp"
#endif
