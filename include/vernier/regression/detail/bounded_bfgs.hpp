// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// A small quasi-Newton minimiser within bounds, for a handful of hyper-parameters.

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Where a minimisation ended.
struct BoundedMinimum {
  VectorX x;     ///< within the bounds
  double value;  ///< there
};

/// Projected BFGS: coordinates at a bound that the gradient presses against stand still, the others take a quasi-Newton
/// step that is cut at the bounds and halved until the value falls enough.
/// @param function   `double(const VectorX& x, VectorX& gradient)`; infinity where it cannot be evaluated
/// @param x          where to start, within the bounds and finite there
/// @param iterations steps at most
/// @param tolerance  of the largest entry of the gradient that can still be followed
/// @cite Bertsekas 1982; Nocedal and Wright 2006
VERNIER_API BoundedMinimum minimise_within(FunctionRef<double(const VectorX& x, VectorX& gradient)> function, VectorX x,
                                           const VectorX& lower, const VectorX& upper, int iterations,
                                           double tolerance);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/regression/detail/bounded_bfgs.ipp"
#endif
