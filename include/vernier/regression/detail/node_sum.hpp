// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Weighted sums over the nodes of a hidden layer or the kernels of a kernel method, evaluated at one sample.

#include "vernier/regression/input_map.hpp"
#include "vernier/regression/scaling.hpp"

namespace vernier::detail {

/// The function of a node: of `z = w'x + b`, or of the squared distance `|x - w|^2`.
enum class NodeFunction { sigmoid, tanh, sine, radial_basis, squared_exponential, matern_5_2 };

/// `y = offset + sum_k coefficients_k g(x; w_k, b_k)`, x being the mapped and scaled features of a sample. Nodes are
/// evaluated as many at a time as the machine's vectors hold; another instruction set gives other last bits.
class NodeSum {
 public:
  /// Numbers that `evaluate` needs as memory to work in.
  static constexpr int workspace(int inputs) { return 2 * max_feature_count(inputs) + 2 * inputs; }

  NodeSum() = default;

  /// @param function     of all nodes
  /// @param map          features of the inputs
  /// @param inputs       their number
  /// @param scaling      of the features
  /// @param weights      features x nodes, w
  /// @param biases       one a node, b; empty where the function has none
  /// @param coefficients nodes x outputs
  /// @param offset       one an output
  VERNIER_API NodeSum(NodeFunction function, InputMap map, int inputs, const ColumnScaling& scaling,
                      const ConstMatrixRef& weights, const ConstVectorRef& biases, const ConstMatrixRef& coefficients,
                      const ConstVectorRef& offset);

  /// Value, and where `slope` is not null the derivative. Does not allocate.
  /// @param x         inputs
  /// @param y         outputs
  /// @param slope     outputs x inputs, column-major
  /// @param workspace `workspace(inputs)` numbers
  VERNIER_API void evaluate(const double* x, double* y, double* slope, double* workspace) const noexcept;

  /// Values of samples, one a row.
  VERNIER_API void evaluate_rows(const ConstMatrixRef& x, MatrixRef y) const;

  /// Mapped and scaled features of a sample.
  /// @param workspace as above; the features are at its beginning
  VERNIER_API void features(const double* x, double* workspace) const noexcept;

  /// Values of the nodes first .. first + count, a multiple of 8 each; those beyond the last have weights of zero.
  /// @param features as above
  VERNIER_API void node_values(const double* features, Index first, Index count, double* out) const noexcept;

  /// Number of nodes.
  Index nodes() const { return nodes_; }
  /// Of the features.
  const ColumnScaling& scaling() const { return scaling_; }
  /// The constant term.
  const VectorX& offset() const { return offset_; }
  /// w, features x nodes.
  VERNIER_API MatrixX weights() const;
  /// w and b of each node, node by node.
  VERNIER_API VectorX weights_and_biases() const;
  /// nodes x outputs.
  VERNIER_API MatrixX coefficients() const;

 private:
  const double* column(Index j) const noexcept { return packed_.data() + j * packed_.rows(); }

  NodeFunction function_ = NodeFunction::sigmoid;
  InputMap map_ = InputMap::raw;
  Index inputs_ = 0, features_ = 0, nodes_ = 0, outputs_ = 0;
  ColumnScaling scaling_;
  MatrixX packed_;  // columns: weights of each feature, biases, coefficients; a row a node, padded with zeros
  VectorX offset_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/node_sum.ipp"
#endif
