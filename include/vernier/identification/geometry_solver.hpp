// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Who solves the least-squares problem of an identification: the library itself, or Ceres.

#include <string>

#include "vernier/core/api.hpp"
#include "vernier/core/function_ref.hpp"

namespace vernier {

namespace detail {

class CalibrationProblem;

}  // namespace detail

/// Outcome of a nonlinear solve.
struct SolverSummary {
  bool converged = true;  ///< whether it converged
  int iterations = 0;     ///< number of linearisations
  std::string message{};  ///< why it ended, in words
};

/// Minimises a problem from its present values, with a limit of iterations; a robust loss settles its scale.
/// `own_solver` needs Eigen alone, `ceres_solver` is in vernier/ceres.hpp. Both find the same minimum.
using GeometrySolver = FunctionRef<SolverSummary(detail::CalibrationProblem& problem, int max_iterations)>;

namespace detail {

/// The solver of `own_solver`.
struct OwnSolver {
  VERNIER_API SolverSummary operator()(CalibrationProblem& problem, int max_iterations) const;
};

}  // namespace detail

/// The library's own solver.
inline constexpr detail::OwnSolver own_solver{};

}  // namespace vernier
