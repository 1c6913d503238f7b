// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Normal equations of a sigmoid hidden layer in one pass over the samples: the inner loop of every ELM search.
///
/// A tile of samples goes through hidden layer, activation and symmetric product while it stays in the first-level
/// cache. Targets are further columns of the tile, so H'T and T'T fall out of the same product.

#include <vector>

#include "vernier/core/simd.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// H'H, H'T and T'T of hidden weights, for layers of sigmoid or tanh nodes. Allocates once, in the constructor.
class LayerEquations {
 public:
  /// Whether there is a kernel for such nodes.
  static bool supports(Activation activation) {
    return activation == Activation::sigmoid || activation == Activation::tanh;
  }

  /// @param layer    its nodes are sigmoid or tanh
  /// @param features samples x inputs, scaled; must outlive this
  /// @param targets  samples x outputs; must outlive this
  /// @param set      instructions to use; must be there
  /// @param keep     whether the outputs of all nodes are kept
  /// @param scale    factors of the rows of H and T, one a sample, which must outlive this; null for 1
  VERNIER_API LayerEquations(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets,
                             InstructionSet set = widest_instruction_set(), bool keep = false,
                             const double* scale = nullptr);

  /// Forms the products at weights `theta`, node by node.
  /// @param shift taken off the outputs of the nodes; null for nothing
  VERNIER_API void form(const ConstVectorRef& theta, const double* shift = nullptr);

  /// Where they are kept: a row a sample, `stride()` apart, outputs of the nodes (less their shift), then the targets.
  const double* outputs() const { return tile_.data(); }
  Index stride() const { return stride_; }
  /// H'H, nodes x nodes; its lower triangle.
  VERNIER_API ConstMatrixRef gram() const { return products_.topLeftCorner(layer_.nodes, layer_.nodes); }
  /// T'H, outputs x nodes.
  VERNIER_API ConstMatrixRef right() const { return products_.block(layer_.nodes, 0, targets_.cols(), layer_.nodes); }
  /// |T|^2.
  double target_square() const {
    double sum = 0;
    for (Index k = layer_.nodes; k < layer_.nodes + targets_.cols(); ++k) sum += products_(k, k);
    return sum;
  }

 private:
  HiddenLayer layer_;
  const MatrixX& features_;
  const MatrixX& targets_;
  InstructionSet set_;
  bool keep_;
  const double* scale_;
  Index stride_ = 0, tile_samples_ = 0;
  std::vector<double> weights_, shift_, tile_;
  MatrixX products_;  // lower triangle
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/layer_equations.ipp"
#endif
