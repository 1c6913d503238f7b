// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Products, sums and decompositions of matrices sized at run time, so that Eigen's kernels for them are compiled once.

#include <span>

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// Whether a decomposition of Eigen came to its end. X11 has a macro with the name of that state, whose value is 0.
template <class Decomposition>
bool succeeded(const Decomposition& decomposition) {
  return decomposition.info() == Eigen::ComputationInfo{};
}

/// out += factor a b
VERNIER_API void add_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b, double factor = 1);
/// out += factor a' b
VERNIER_API void add_transposed_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b,
                                        double factor = 1);

/// a x
VERNIER_API VectorX product(const ConstMatrixRef& a, const ConstVectorRef& x);
/// a' x
VERNIER_API VectorX transposed_product(const ConstMatrixRef& a, const ConstVectorRef& x);
/// a b
VERNIER_API MatrixX matrix_product(const ConstMatrixRef& a, const ConstMatrixRef& b);
/// a' b
VERNIER_API MatrixX transposed_matrix_product(const ConstMatrixRef& a, const ConstMatrixRef& b);

/// diag(factors) a
VERNIER_API MatrixX rows_scaled(const ConstVectorRef& factors, const ConstMatrixRef& a);
/// a diag(factors)
VERNIER_API MatrixX columns_scaled(const ConstMatrixRef& a, const ConstVectorRef& factors);
/// a, less the same row from each of its rows.
VERNIER_API MatrixX rows_minus(const ConstMatrixRef& a, const ConstVectorRef& row);

/// The i-th row, as a column.
VERNIER_API VectorX row_of(const ConstMatrixRef& a, Index i);
/// Some rows, in the order given.
VERNIER_API MatrixX rows_of(const ConstMatrixRef& a, std::span<const Index> rows);
/// Some columns, in the order given.
VERNIER_API MatrixX columns_of(const ConstMatrixRef& a, std::span<const Index> columns);
/// The diagonal.
VERNIER_API VectorX diagonal_of(const ConstMatrixRef& a);
/// Mean of each column.
VERNIER_API VectorX column_means(const ConstMatrixRef& a);
/// Squared norm of each column.
VERNIER_API VectorX squared_column_norms(const ConstMatrixRef& a);
/// Squared norm of each row.
VERNIER_API VectorX squared_row_norms(const ConstMatrixRef& a);
/// Sum of weighted squares.
VERNIER_API double weighted_square(const ConstVectorRef& weights, const ConstVectorRef& values);
/// Whether no element is infinite or not a number.
VERNIER_API bool all_finite(const ConstMatrixRef& a);

/// Cholesky factorisation of a symmetric matrix, its lower triangle, in place.
/// @return whether it is positive definite
VERNIER_API bool cholesky(MatrixRef matrix);
/// Solves L x = b for the lower triangle L, in place.
VERNIER_API void solve_lower(const ConstMatrixRef& factor, MatrixRef right);
/// Solves L' x = b for the lower triangle L, in place.
VERNIER_API void solve_lower_transposed(const ConstMatrixRef& factor, MatrixRef right);
/// Solves L L' x = b for the lower triangle L, in place.
VERNIER_API void solve_cholesky(const ConstMatrixRef& factor, MatrixRef right);
/// log |L L'| for the lower triangle L.
VERNIER_API double cholesky_log_determinant(const ConstMatrixRef& factor);
/// Inverse of L L'.
VERNIER_API MatrixX inverse_from_cholesky(const ConstMatrixRef& factor);

/// Solves a x = b by Gaussian elimination with partial pivoting, both in place.
/// @return logarithm of the absolute determinant of a
VERNIER_API double solve_general(MatrixRef a, VectorRef b);

/// R of the QR decomposition of a matrix of n columns, n x n.
VERNIER_API MatrixX triangular_factor(const ConstMatrixRef& matrix);

/// Least squares by QR, for at least as many rows as columns, which are linearly independent.
struct QrSolution {
  MatrixX solution;  ///< of `min |matrix x - right|`
  MatrixX triangle;  ///< R, n x n
};
/// Solves least squares by a QR decomposition.
VERNIER_API QrSolution solve_by_qr(const ConstMatrixRef& matrix, const ConstMatrixRef& right);

/// Eigenvalues, in ascending order, and eigenvectors of a symmetric matrix, its lower triangle.
struct SymmetricEigen {
  VectorX values;   ///< n
  MatrixX vectors;  ///< n x n
  bool converged;   ///< false where a value is not finite
};
/// Decomposes a symmetric matrix, of which the lower triangle is read.
VERNIER_API SymmetricEigen symmetric_eigen(const ConstMatrixRef& matrix);

/// Tridiagonal form of a symmetric matrix, its lower triangle: `Q T Q'` for an orthogonal Q. Where T will do, this
/// takes a fraction of the time of eigenvectors.
struct TridiagonalForm {
  MatrixX basis;        ///< Q, n x n
  VectorX diagonal;     ///< of T, n
  VectorX subdiagonal;  ///< of T, n - 1
};
/// Brings a symmetric matrix, of which the lower triangle is read, to tridiagonal form.
VERNIER_API TridiagonalForm tridiagonal_form(const ConstMatrixRef& matrix);

/// Singular values, in descending order, and right singular vectors of a matrix of n columns and at least as many rows.
struct RightSingular {
  VectorX values;   ///< n
  MatrixX vectors;  ///< n x n
};
/// Singular values and right singular vectors by Jacobi rotations: slow and accurate.
VERNIER_API RightSingular right_singular(const ConstMatrixRef& matrix);

/// Thin singular value decomposition `H = U diag(s) V'`: QR of the longer side, then one-sided Jacobi rotations of the
/// square factor, the most accurate method.
struct ThinSvd {
  MatrixX u;  ///< n x k, k = min(n, h)
  VectorX s;  ///< k, descending
  MatrixX v;  ///< h x k
};
/// Decomposes a matrix as `U diag(s) V'`.
/// @param h n x h
VERNIER_API ThinSvd thin_svd(const ConstMatrixRef& h);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/dense.ipp"
#endif
