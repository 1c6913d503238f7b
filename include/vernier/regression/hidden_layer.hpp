// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// One hidden layer of an extreme learning machine: input map, scaling, weights, activation.

#include <cstdint>

#include "vernier/core/box.hpp"
#include "vernier/regression/input_map.hpp"
#include "vernier/regression/scaling.hpp"

namespace vernier {

/// The function of a hidden node, z = w'x + b.
enum class Activation {
  sigmoid,       ///< 1 / (1 + exp(-z))
  tanh,          ///< tanh(z)
  sine,          ///< sin(z)
  radial_basis,  ///< exp(-b^2 |x - w|^2): w is a centre, b an inverse width
};

/// The hidden layer as a recipe; shared by the members of the ELM family.
/// @cite Huang 2006
struct HiddenLayer {
  int nodes = 65;  ///< number of hidden nodes, at least 1
  /// Function of the hidden nodes.
  Activation activation = Activation::sigmoid;
  /// Features of the inputs.
  InputMap input_map = InputMap::raw;
  Scaling input_scaling = Scaling::min_max;  ///< of the features; that of sines and cosines alone is `Scaling::none`
  double weight_limit = 1;                   ///< weights and biases lie in [-limit, limit]

  /// Number of features of a number of inputs.
  int features(int inputs) const { return detail::feature_count(input_map, inputs); }
  /// Number of weights and biases.
  Index dimension(int inputs) const { return static_cast<Index>(nodes) * (features(inputs) + 1); }
  /// Where weights and biases lie.
  VERNIER_API Box box(int inputs) const;

  /// @throws std::invalid_argument naming an unusable value
  VERNIER_API void validate(const char* caller) const;

  /// Weights drawn uniformly from the box.
  VERNIER_API VectorX draw(int inputs, std::uint64_t seed) const;

  /// Features of samples before scaling, n x features.
  VERNIER_API MatrixX map(const ConstMatrixRef& inputs) const;

  /// Scaling of the mapped features.
  VERNIER_API ColumnScaling scaling(const ConstMatrixRef& mapped) const;

  /// H, n x nodes, of scaled features n x features at weights `theta`. `out` is resized only when its shape differs.
  VERNIER_API void outputs(const ConstMatrixRef& features, const ConstVectorRef& theta, MatrixX& out) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/regression/hidden_layer.ipp"
#endif
