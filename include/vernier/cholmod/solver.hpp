// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// CHOLMOD as the sparse solver of least squares with local unknowns.

#include "vernier/least_squares/sparse_solve.hpp"

namespace vernier {

/// A `SparseSolve` by CHOLMOD's Cholesky factorisation: supernodal where that is faster, with a fill-reducing ordering.
/// Takes the place of `EigenSparseSolver` where local unknowns are many and coupled.
///
///     const CholmodSolver cholmod;
///     const FactorisedEquations solved(normal, precisions, steps, local_steps, cholmod);
/// @cite Chen, Davis, Hager and Rajamanickam 2008
struct CholmodSolver {
  /// Solves by CHOLMOD's supernodal factorisation.
  /// @throws std::bad_alloc where memory is exhausted
  VERNIER_API SparseOutcome operator()(const SparseSymmetric& matrix, MatrixRef right) const;
};

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/cholmod/solver.ipp"
#endif
