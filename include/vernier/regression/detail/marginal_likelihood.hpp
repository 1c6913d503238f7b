// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Marginal likelihood of the hyper-parameters of a Gaussian process, with its exact gradient.

#include "vernier/regression/kernel_predictor.hpp"

namespace vernier::detail {

/// One for each output that varies by more than rounding, zero for the others.
VERNIER_API VectorX varying_outputs(const ConstMatrixRef& targets);

/// The log marginal likelihood of a Gaussian process, summed over outputs that share length scales and the ratio of
/// noise to signal variance. Mean and signal variance of each output are at their best, which has a closed form
/// (`s^2 = r / N`, `r = (T - mean)' A^-1 (T - mean)`, `A = K + ratio W^-1`, N the sum of the weights), so the unknowns
/// are the logarithms of the length scales, one an input, and of the ratio, which comes last. A sample of weight w
/// counts as w samples: its likelihood is raised to the power of w. Constant outputs are left out.
/// @cite Rasmussen and Williams 2006
class MarginalLikelihood {
 public:
  /// @param features n x features before length scales; feature j belongs to input j modulo `inputs`
  /// @param targets  n x outputs
  /// @param weights  n
  VERNIER_API MarginalLikelihood(Kernel kernel, MatrixX features, int inputs, MatrixX targets, VectorX weights)
      : kernel_(kernel),
        features_(std::move(features)),
        inputs_(inputs),
        targets_(std::move(targets)),
        weights_(std::move(weights)),
        varying_(varying_outputs(targets_)) {}

  /// Minus the log likelihood for each unit of weight and output, and its gradient; infinity where A is singular.
  /// O(n^3).
  VERNIER_API double operator()(const VectorX& logarithms, VectorX& gradient) const;

 private:
  /// Derivative of the kernel with respect to the logarithm of a length scale, divided by the square of the distance
  /// along it.
  VERNIER_API VectorX slope(VectorX square) const;

  Kernel kernel_;
  MatrixX features_;
  int inputs_;
  MatrixX targets_;
  VectorX weights_;
  VectorX varying_;
};

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/marginal_likelihood.ipp"
#endif
