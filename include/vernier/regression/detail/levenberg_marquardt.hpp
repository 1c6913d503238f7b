// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Levenberg-Marquardt with exact gradients and Gauss-Newton matrices, for networks.

#include "vernier/core/executor.hpp"
#include "vernier/core/function_ref.hpp"

namespace vernier::detail {

/// A sum of squares. `gradient` and `curvature` are called for the weights of the last `evaluate` that was better than
/// all before it.
struct LeastSquaresProblem {
  FunctionRef<double(const VectorX& theta)> evaluate;                          ///< infinity where it is not finite
  FunctionRef<VectorX()> gradient;                                             ///< its derivative
  FunctionRef<void(MatrixX& lower_triangle, ExecutorRef executor)> curvature;  ///< the Gauss-Newton matrix
};

/// The damping follows the ratio of actual to predicted decrease.
/// @param theta      where to start; then the best weights found
/// @param iterations steps tried
/// @param tolerance  ten accepted steps that together lower the value by less than this share end it
/// @param watch      called with the best value for the start and after every step; false ends it
/// @return           the value at theta
/// @cite Levenberg 1944; Marquardt 1963; Nielsen 1999
VERNIER_API double levenberg_marquardt(const LeastSquaresProblem& problem, VectorX& theta, int iterations,
                                       double tolerance, ExecutorRef executor, FunctionRef<bool(double best)> watch);

/// Levenberg-Marquardt on an object that has these members.
template <class Problem>
double levenberg_marquardt(Problem& problem, VectorX& theta, int iterations, double tolerance, ExecutorRef executor,
                           FunctionRef<bool(double best)> watch) {
  const auto evaluate = [&](const VectorX& at) { return problem.evaluate(at); };
  const auto gradient = [&] { return problem.gradient(); };
  const auto curvature = [&](MatrixX& out, ExecutorRef shared) { problem.curvature(out, shared); };
  return levenberg_marquardt(LeastSquaresProblem{evaluate, gradient, curvature}, theta, iterations, tolerance, executor,
                             watch);
}

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/levenberg_marquardt.ipp"
#endif
