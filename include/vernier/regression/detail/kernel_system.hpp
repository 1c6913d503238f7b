// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The linear system of kernel methods: (K + N) alpha = T - mean, with the mean of generalised least squares.

#include "vernier/regression/hidden_layer.hpp"
#include "vernier/regression/kernel_predictor.hpp"

namespace vernier::detail {

/// Features of samples for a kernel.
struct KernelFeatures {
  InputMap input_map;     ///< of the inputs
  ColumnScaling scaling;  ///< of the mapped features
  MatrixX values;         ///< n x features, mapped and scaled

  /// Mapped and scaled, without length scales.
  VERNIER_API KernelFeatures(const ConstMatrixRef& inputs, InputMap map, Scaling input_scaling);

  /// Divides by length scales: one for all features, or one an input.
  VERNIER_API void divide(const VectorX& length_scales);
};

/// The Cholesky factor of `A = K + diag(noise)` and the solution. The mean is that of generalised least
/// squares, so that alpha sums to zero: `mean = 1'A^-1 T / 1'A^-1 1`, `alpha = A^-1 (T - 1 mean)`. O(n^3).
struct KernelSystem {
  MatrixX factor;    ///< A's Cholesky factor, in the lower triangle
  VectorX ones;      ///< A^-1 1
  double precision;  ///< 1'A^-1 1
  VectorX mean;      ///< one an output
  MatrixX alpha;     ///< n x outputs
  VectorX square;    ///< (T - mean)'A^-1 (T - mean), one an output
  bool solved;       ///< false where A is not positive definite; then nothing else is valid

  /// @param a       K, its lower triangle
  /// @param noise   added to its diagonal
  /// @param targets n x outputs
  VERNIER_API KernelSystem(MatrixX a, const VectorX& noise, const ConstMatrixRef& targets);

  /// log |A|
  VERNIER_API double log_determinant() const;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/kernel_system.ipp"
#endif
