// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The iteration of all nonlinear least-squares problems of calibration: Levenberg-Marquardt on normal equations, with
/// a robust loss reweighted before every step.

#include "vernier/core/function_ref.hpp"
#include "vernier/least_squares/normal_equations.hpp"

namespace vernier {

/// A problem, linearised at its present values.
struct LinearisedProblem {
  NormalEquations normal;     ///< of the rows, weighted by the loss
  VectorX precisions;         ///< of independent priors of dense and factored unknowns; 0 for none
  VectorX steps;              ///< present values of these unknowns, relative to the means of the priors
  VectorX local_steps{};      ///< the same of local unknowns
  double with_old_weights{};  ///< sum of squares of the rows and priors, rows weighted as at the values kept last
  double with_new_weights{};  ///< the same, rows weighted as now
};

/// What the iteration asks of a problem.
struct IteratedProblem {
  FunctionRef<LinearisedProblem()> linearise;                              ///< at the present values, with new weights
  FunctionRef<void(const VectorX& step, const VectorX& local_step)> move;  ///< changes the present values
  FunctionRef<void()> keep;                                                ///< keeps the present values and weights
  FunctionRef<void()> restore;                                             ///< returns to those that were kept
};

/// When the iteration ends.
struct IterationLimits {
  int max_iterations = 20;   ///< the last step is taken without a check that it lowered the sum of squares
  double least_step = 1e-6;  ///< converged where no unknown moves by more, in its unit
  double least_gain = 0;     ///< or where a step lowers the sum of squares by less than this share
  double most_damping = 1;   ///< above it small steps are no sign of a minimum
};

/// How it ended.
struct IterationEnd {
  bool converged = false;  ///< whether steps vanished
  bool usable = true;      ///< whether the normal equations could be solved
  int iterations = 0;      ///< number of linearisations
};

/// Minimises a problem from its present values: undamped steps until one fails, damped ones from there.
/// @cite Levenberg 1944; Marquardt 1963; Nielsen 1999
VERNIER_API IterationEnd minimise(const IteratedProblem& problem, const IterationLimits& limits);

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/damped_iteration.ipp"
#endif
