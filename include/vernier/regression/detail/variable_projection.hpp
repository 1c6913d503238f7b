// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The training error of a hidden layer as a function of its weights alone, output weights always at their best:
/// value, exact gradient, Gauss-Newton curvature.

#include <vector>

#include "vernier/core/executor.hpp"
#include "vernier/core/simd.hpp"
#include "vernier/regression/hidden_layer.hpp"

namespace vernier::detail {

/// `F(w) = min over B, c of |H(w) B + 1 c' - T|^2 / n + ridge |B|^2`, H being the hidden layer at weights w. Where
/// samples are weighted, their squares are, and n is the sum of the weights: all rows below are times the roots of
/// those.
///
/// A node's output has derivatives `s(z) L phi`: a slope, times features phi that all nodes share, through a small
/// matrix of the node (the identity but for radial bases). With S the slopes, the Jacobian of the residuals of output o
/// has columns `B(k, o) s_k phi_j`, and its Gauss-Newton matrix, summed over outputs, is `(B B')(k, k')` times
/// `S' diag(phi_j phi_j') S`: as many narrow symmetric products as there are pairs of features, and no Jacobian. What
/// the output weights take over (Kaufman's projection) is the same factor times `C (H'H + n ridge)^-1 C'`, C = (S
/// phi)'H.
/// @cite Golub and Pereyra 1973; Kaufman 1975
class VariableProjection {
 public:
  /// @param layer    the nodes
  /// @param features n x f, scaled
  /// @param targets  n x m, centred
  /// @param ridge    of the output weights, per sample, positive
  /// @param weights  n weights of the samples, positive; null: all the same
  /// @param set      instructions to use; must be there
  VERNIER_API VariableProjection(const HiddenLayer& layer, const MatrixX& features, const MatrixX& targets,
                                 double ridge, const VectorX* weights = nullptr,
                                 InstructionSet set = widest_instruction_set());

  /// Number of hidden weights and biases.
  Index dimension() const { return nodes_ * (features_.cols() + 1); }

  /// F at weights `theta`, at which the other members are then evaluated; infinity where a node is not finite.
  VERNIER_API double evaluate(const ConstVectorRef& theta);

  /// dF/dw. By the envelope theorem the output weights, being at their best, need not be differentiated.
  VERNIER_API VectorX gradient();

  /// Kaufman's Gauss-Newton approximation of d2F/dw2.
  /// @param out      dimension x dimension, its lower triangle
  /// @param executor the bits do not depend on it
  VERNIER_API void curvature(MatrixX& out, ExecutorRef executor = {});

  /// Output weights, nodes x m, at the last weights evaluated.
  const MatrixX& beta() const { return beta_; }
  /// Intercept of `H beta`, m.
  VERNIER_API VectorX offset() const;

 private:
  bool radial() const { return layer_.activation == Activation::radial_basis; }

  /// The layer's outputs, one sample a column, times the roots of the weights.
  VERNIER_API void fill(const VectorX& theta, MatrixX& columns) const;

  /// The slopes of all nodes at all samples, from their outputs.
  VERNIER_API void find_slopes();

  /// L_k times rows that belong to the shared features: rows that belong to the weights and the bias of node k.
  VERNIER_API MatrixX to_weights(Index k, const ConstMatrixRef& rows) const;

  /// Tasks below the number of pairs: S' diag(phi_j phi_i) S, its lower triangle. The others: [H 1 T]' (S phi_j).
  VERNIER_API void products_of_pairs(Index begin, Index end);

  /// 24 KiB, the first-level cache.
  Index tile_samples() const { return 3072 / stride_ > 8 ? 3072 / stride_ : 8; }

  /// Columns, of a multiple of 8 rows, times their transpose are added to the lower triangle of `out`.
  VERNIER_API void add_square(const MatrixX& columns, MatrixX& out, Index tile_columns) const;

  /// Cholesky of the products; of the samples where that fails.
  VERNIER_API void factorise(MatrixX gram);

  VERNIER_API MatrixX solve(MatrixX right) const;

  HiddenLayer layer_;
  MatrixX features_;
  VectorX roots_;    // of the weights
  MatrixX targets_;  // times them
  Index samples_, nodes_;
  double n_, lambda_;
  InstructionSet set_;
  Index stride_;
  MatrixX shared_;                // n x d: features, one, and for radial bases their squared norm
  MatrixX hidden_;                // stride x n: H, one, targets (each times roots_), zeros
  MatrixX products_;              // of hidden_ with itself, lower triangle
  VectorX ones_, theta_, mean_;   // mean_ of H
  MatrixX factor_;                // lower, of the centred H'H + lambda
  MatrixX beta_, residual_;       // nodes x m, n x m: roots times T - H beta - mean
  MatrixX slopes_;                // stride x n
  std::vector<MatrixX> by_pair_;  // see products_of_pairs
  bool slopes_known_ = false;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/variable_projection.ipp"
#endif
