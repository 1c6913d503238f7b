#pragma once

/// @file
/// Products and decompositions of run-time-sized matrices, so that Eigen's kernels are compiled once for the whole
/// house.

#include "vernier/core/types.hpp"

namespace vernier::detail {

/// out += factor a b
VERNIER_API void add_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b, double factor = 1);
/// out += factor a' b
VERNIER_API void add_transposed_product(MatrixRef out, const ConstMatrixRef& a, const ConstMatrixRef& b,
                                        double factor = 1);

/// Cholesky factorisation of a symmetric matrix, its lower triangle, in place.
/// @return whether it is positive definite
VERNIER_API bool cholesky(MatrixRef matrix);
/// Solves L x = b for the lower triangle L, in place.
VERNIER_API void solve_lower(const ConstMatrixRef& factor, MatrixRef right);
/// Solves L' x = b for the lower triangle L, in place.
VERNIER_API void solve_lower_transposed(const ConstMatrixRef& factor, MatrixRef right);
/// Inverse of L L'.
VERNIER_API MatrixX inverse_from_cholesky(const ConstMatrixRef& factor);

/// Solves a x = b by Gaussian elimination with partial pivoting, both in place.
/// @return logarithm of the absolute determinant of a
VERNIER_API double solve_general(MatrixRef a, VectorRef b);

/// R of the QR decomposition of a matrix of n columns, n x n.
VERNIER_API MatrixX triangular_factor(const ConstMatrixRef& matrix);

/// Singular values, in descending order, and right singular vectors of a matrix of n columns and at least as many rows.
struct RightSingular {
  VectorX values;   ///< n
  MatrixX vectors;  ///< n x n
};
/// See `RightSingular`. By Jacobi rotations: slow and accurate.
VERNIER_API RightSingular right_singular(const ConstMatrixRef& matrix);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/core/detail/dense.ipp"
#endif
