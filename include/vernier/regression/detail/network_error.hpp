// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The training error of a network of one hidden layer as a function of all its weights: value, exact gradient,
/// Gauss-Newton curvature.

#include <vector>

#include "vernier/core/executor.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// `F = sum_i q_i |B'h_i + c - t_i|^2 / sum q + decay (|W|^2 + |B|^2)`, h_i being the outputs of sigmoid or tanh nodes.
///
/// Weights lie in one vector: those of the hidden layer, node by node, then of each output B's column and c. With S the
/// slopes of the nodes and phi_j the features and one, the residuals of output o have the derivatives `B(k, o) s_k
/// phi_j`, h_k and 1, so the Gauss-Newton matrix needs no Jacobian: between hidden weights it is `(B B')(k, k')` times
/// `S' diag(phi_j phi_j') S`, between hidden and output weights `B(k, o)` times `S' diag(phi_j) [H 1]`, and for every
/// output the same `[H 1]'[H 1]`.
/// @cite Rumelhart 1986 (the gradient); Hagan and Menhaj 1994 (Gauss and Newton's matrix)
class NetworkError {
 public:
  /// @param layer    sigmoid or tanh nodes
  /// @param features n x f, scaled
  /// @param targets  n x m, scaled
  /// @param weights  q, n; only their ratios matter
  /// @param decay    of all weights but biases, 0 or more
  /// @param set      instructions to use; must be there
  VERNIER_API NetworkError(const HiddenLayer& layer, MatrixX features, MatrixX targets, const VectorX& weights,
                           double decay, InstructionSet set = widest_instruction_set())
      : layer_(layer),
        features_(std::move(features)),
        targets_(std::move(targets)),
        shares_(weights / weights.sum()),
        decay_(decay),
        set_(set) {}

  /// Number of samples.
  Index samples() const { return features_.rows(); }
  /// Number of hidden weights and biases.
  Index hidden() const { return layer_.nodes * (features_.cols() + 1); }
  /// Number of all weights.
  Index dimension() const { return hidden() + (layer_.nodes + 1) * targets_.cols(); }

  /// F at weights `theta`, at which `gradient` and `curvature` are then evaluated; infinity where it is not finite.
  VERNIER_API double evaluate(const VectorX& theta);

  /// dF/dtheta.
  VERNIER_API VectorX gradient();

  /// The gradient of F of a mini-batch, an unbiased estimate of that of all samples. @return the value of F of the
  /// batch
  VERNIER_API double batch(const VectorX& theta, const std::vector<Index>& rows, VectorX& gradient);

  /// The Gauss-Newton approximation of d2F/dtheta2.
  /// @param out      dimension x dimension, its lower triangle
  /// @param executor the bits do not depend on it
  VERNIER_API void curvature(MatrixX& out, ExecutorRef executor = {});

 private:
  /// B; after every column a bias.
  VERNIER_API Eigen::Map<const MatrixX, 0, Eigen::OuterStride<>> output_weights() const {
    return {theta_.data() + hidden(), layer_.nodes, targets_.cols(), Eigen::OuterStride<>(layer_.nodes + 1)};
  }

  VERNIER_API double over_samples(VectorX* gradient);

  VERNIER_API double add_decay(VectorX* gradient) const;

  /// Forwards, and back where a gradient is asked for.
  VERNIER_API double add(const ConstMatrixRef& x, const ConstMatrixRef& t, const ConstVectorRef& q, VectorX* gradient);

  /// Outputs of nodes become their slopes.
  VERNIER_API void to_slopes(MatrixX& h) const;

  /// [H 1] and S of all samples, a sample a column.
  VERNIER_API void fill();

  /// Tasks below the number of pairs: S' diag(q phi_j phi_i) S. Then [H 1]' diag(q phi_j) S. The last: [H 1]'Q[H 1].
  /// Of symmetric products the lower triangle.
  VERNIER_API void form_products(Index begin, Index end);

  HiddenLayer layer_;
  MatrixX features_, targets_;
  VectorX shares_;  // of the samples in the weight there is
  double decay_;
  InstructionSet set_;
  VectorX theta_;
  MatrixX outputs_, residual_, pulled_;  // scratch
  Index stride_ = 0;
  MatrixX nodes_, slopes_;         // stride x n: [H 1], S, zeros
  std::vector<MatrixX> products_;  // see form_products
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/network_error.ipp"
#endif
