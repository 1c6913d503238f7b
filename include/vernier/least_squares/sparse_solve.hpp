// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Sparse symmetric positive definite systems: the one place where a sparse solver is called.

#include <vector>

#include "vernier/core/function_ref.hpp"
#include "vernier/core/types.hpp"

namespace vernier {

/// A symmetric matrix, its lower triangle compressed by columns; rows of a column ascend.
struct SparseSymmetric {
  Index size = 0;              ///< rows and columns
  std::vector<int> starts{};   ///< of each column among `rows` and `values`, size + 1 entries
  std::vector<int> rows{};     ///< row of each entry
  std::vector<double> values;  ///< the entries
};

/// Outcome of a sparse solve.
struct SparseOutcome {
  bool solved = false;         ///< false where the matrix is not positive definite
  double log_determinant = 0;  ///< of the matrix
};

/// Solves `matrix X = right` in place for any number of columns.
using SparseSolve = FunctionRef<SparseOutcome(const SparseSymmetric& matrix, MatrixRef right)>;

/// A `SparseSolve` by Eigen's simplicial Cholesky factorisation, the default everywhere; `CholmodSolver` of the
/// component `cholmod` takes its place.
struct EigenSparseSolver {
  /// Solves by Eigen's sparse Cholesky factorisation.
  VERNIER_API SparseOutcome operator()(const SparseSymmetric& matrix, MatrixRef right) const;
};

/// The default.
inline constexpr EigenSparseSolver eigen_sparse_solver{};

namespace detail {

/// `matrix x`.
VERNIER_API VectorX multiply(const SparseSymmetric& matrix, const VectorX& x);

}  // namespace detail

}  // namespace vernier

#if VERNIER_HEADER_ONLY
#include "vernier/least_squares/sparse_solve.ipp"
#endif
