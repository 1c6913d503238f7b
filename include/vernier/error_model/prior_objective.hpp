// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// The priors of an error model as an objective that a metaheuristic may minimise.

#include "vernier/core/box.hpp"
#include "vernier/core/function_ref.hpp"
#include "vernier/least_squares/normal_equations.hpp"

namespace vernier {

/// Mean leave-one-pose-out position error [m] as a function of the priors of the joint errors, in closed form at the
/// linearised problem. A batch objective: columns of a population are independent.
///
/// The variables: decimal logarithms of relative precisions (1: the expected sizes; t: sizes divided by sqrt(t)), of
/// the elastic terms where there are any, then of every joint that has transmission terms; last an exponent e of the
/// expected spectrum: amplitudes are a^e for the expected ones a, relative to the joint's first.
/// @cite Allen 1974
class PriorObjective {
 public:
  /// @param system      poses, linearised; outlives this
  /// @param normal      their normal equations; outlives this
  /// @param precisions  of all unknowns; those of geometry stay
  /// @param steps       present values of the unknowns
  /// @param num_elastic number of elastic terms, the last of the dense unknowns
  /// @param amplitudes  expected amplitude of each transmission term relative to its joint's first
  /// @param stride      every stride-th pose is left out
  VERNIER_API PriorObjective(const BlockSystem& system, const NormalEquations& normal, VectorX precisions,
                             VectorX steps, Index num_elastic, VectorX amplitudes, Index stride);

  /// Number of variables.
  VERNIER_API Index dimension() const;
  /// Bounds: relative precisions 0.1 to 1e4, exponents 0.5 to 2.
  VERNIER_API Box box() const;
  /// The precisions of all unknowns at a point.
  VERNIER_API VectorX precisions(const ConstVectorRef& variables) const;
  /// The error with some precisions [m]; infinite where they leave the problem singular.
  VERNIER_API double error(const VectorX& precisions) const;
  /// @param population dimension x particles
  /// @param fitness    one value a particle [m]
  VERNIER_API void operator()(const ConstMatrixRef& population, VectorRef fitness) const;

 private:
  const BlockSystem& system_;
  const NormalEquations& normal_;
  VectorX precisions_, steps_;
  Index num_elastic_;
  VectorX amplitudes_;
  Index stride_;
};

/// Finds a point of the box whose objective is small, e.g. by `minimize`.
using PriorSearch = FunctionRef<VectorX(const PriorObjective&, const Box&)>;

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/error_model/prior_objective.ipp"
#endif
