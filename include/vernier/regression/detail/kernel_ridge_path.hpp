// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Leave-one-out errors of kernel ridge regression.

#include "vernier/core/detail/dense.hpp"

namespace vernier::detail {

/// Leave-one-out errors of kernel ridge regression with an unpenalised mean, for every lambda from one decomposition of
/// the weighted kernel matrix, `W^1/2 K W^1/2 = Q T Q'` with T tridiagonal. A sample is left out with all its weight.
/// O(n^3) once, then O(n^2) a lambda.
/// @cite Dubrule 1983
class KernelRidgePath {
 public:
  /// @param k       K, its lower triangle
  /// @param targets n x outputs
  /// @param weights n
  VERNIER_API KernelRidgePath(MatrixX k, const ConstMatrixRef& targets, const VectorX& weights);

  /// Errors of leaving each sample out, n x outputs; an infinite lambda is the mean alone.
  VERNIER_API MatrixX leave_one_out_residuals(double lambda) const;

  /// Their weighted mean square, summed over outputs.
  VERNIER_API double leave_one_out_error(double lambda) const;

 private:
  VectorX root_;
  MatrixX targets_;
  TridiagonalForm form_;
  MatrixX projected_;  // Q' W^1/2 (1, targets)
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/kernel_ridge_path.ipp"
#endif
