// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vernier/core/check.hpp"
#include "vernier/regression/elm_predictor.hpp"

namespace vernier::detail {

VERNIER_IMPL NodeSum node_sum_of(const FittedNetwork& network, int inputs) {
  const HiddenLayer& layer = network.layer;
  const Index f = layer.features(inputs);
  demand(network.theta.size() == layer.dimension(inputs) && network.beta.rows() == layer.nodes &&
             network.scaling.offset.size() == f && network.scaling.factor.size() == f,
         "ElmPredictor: ", layer.nodes, " nodes of ", f, " features need ", layer.dimension(inputs), " weights and ",
         layer.nodes, " rows of output weights, got ", network.theta.size(), " and ", network.beta.rows());
  const Eigen::Map<const MatrixX, 0, Eigen::OuterStride<>> weights(network.theta.data(), f, layer.nodes,
                                                                   Eigen::OuterStride<>(f + 1));
  VectorX biases(layer.nodes);
  for (Index k = 0; k < biases.size(); ++k) biases(k) = network.theta(k * (f + 1) + f);
  return {static_cast<NodeFunction>(layer.activation),  // the first four of them
          layer.input_map,
          inputs,
          network.scaling,
          weights,
          biases,
          network.beta,
          network.offset};
}

}  // namespace vernier::detail
