// SPDX-License-Identifier: BSD-3-Clause
// Products and decompositions by their definitions, small and so large that kernels of wide instructions compute them.

#include "vernier/core/detail/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"

namespace vernier::dense_test {
namespace {

using namespace detail;
using namespace vernier_test;

constexpr Index sizes[] = {1, 2, 5, 33, 200};

MatrixX random(Index rows, Index cols, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, cols);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i < rows; ++i) out(i, j) = rng.uniform(-1, 1);
  return out;
}

/// Positive definite, eigenvalues 1 and more.
RealMatrix positive(Index n, std::uint64_t seed) {
  const RealMatrix a = random(n, n, seed);
  return a * a.transpose() + RealMatrix::identity(n);
}

// Each entry, summed by hand.
TEST(DenseWhiteBox, ProductsAreAdded) {
  for (const Index n : sizes) {
    const MatrixX a = random(n + 1, n, 1), b = random(n, n + 2, 2), c = random(n + 1, n + 2, 3);
    MatrixX product = c, transposed = random(n, n + 2, 4);
    const MatrixX before = transposed;
    add_product(product, a, b, -0.5);
    add_transposed_product(transposed, a, c, 2);
    for (Index i = 0; i <= n; ++i)
      for (Index j = 0; j < n + 2; ++j) {
        double sum = c(i, j);
        for (Index k = 0; k < n; ++k) sum -= 0.5 * a(i, k) * b(k, j);
        ASSERT_NEAR(product(i, j), sum, 1e-13 * static_cast<double>(n)) << n << ": " << i << ", " << j;
        if (i == n) continue;
        sum = before(i, j);
        for (Index k = 0; k <= n; ++k) sum += 2 * a(k, i) * c(k, j);
        ASSERT_NEAR(transposed(i, j), sum, 1e-13 * static_cast<double>(n)) << n << ": " << i << ", " << j;
      }
  }
}

// By hand: a = [1 2; 3 4; 5 6].
TEST(DenseWhiteBox, ProductsScalingsAndSums) {
  const RealMatrix a(3, 2, {1, 2, 3, 4, 5, 6}), b(2, 3, {1, 0, 2, -1, 3, 1});
  EXPECT_EQ(RealMatrix(product(a, vector({1, -2}))), vector({-3, -5, -7}));
  EXPECT_EQ(RealMatrix(transposed_product(a, vector({1, 0, -1}))), vector({-4, -4}));
  EXPECT_EQ(RealMatrix(matrix_product(a, b)), RealMatrix(3, 3, {-1, 6, 4, -1, 12, 10, -1, 18, 16}));
  EXPECT_EQ(RealMatrix(transposed_matrix_product(a, b.transpose())), RealMatrix(2, 2, {11, 13, 14, 16}));
  EXPECT_EQ(RealMatrix(rows_scaled(vector({2, 0, -1}), a)), RealMatrix(3, 2, {2, 4, 0, 0, -5, -6}));
  EXPECT_EQ(RealMatrix(columns_scaled(a, vector({2, -1}))), RealMatrix(3, 2, {2, -2, 6, -4, 10, -6}));
  EXPECT_EQ(RealMatrix(rows_minus(a, vector({1, 4}))), RealMatrix(3, 2, {0, -2, 2, 0, 4, 2}));
  EXPECT_EQ(RealMatrix(row_of(a, 1)), vector({3, 4}));
  EXPECT_EQ(RealMatrix(rows_of(a, std::vector<Index>{2, 0, 2})), RealMatrix(3, 2, {5, 6, 1, 2, 5, 6}));
  EXPECT_EQ(RealMatrix(columns_of(a, std::vector<Index>{1, 0})), RealMatrix(3, 2, {2, 1, 4, 3, 6, 5}));
  EXPECT_EQ(RealMatrix(diagonal_of(a)), vector({1, 4}));
  EXPECT_EQ(RealMatrix(diagonal_of(b)), vector({1, 3}));
  EXPECT_EQ(RealMatrix(column_means(a)), vector({3, 4}));
  EXPECT_EQ(RealMatrix(squared_column_norms(a)), vector({35, 56}));
  EXPECT_EQ(RealMatrix(squared_row_norms(a)), vector({5, 25, 61}));
  EXPECT_EQ(weighted_square(vector({1, 2, -3}), vector({4, 5, 6})), -42);
}

TEST(DenseWhiteBox, WhatIsNotFiniteIsSeenAnywhere) {
  const RealMatrix fine(2, 3, {1, -2, 0, 1e300, -1e-300, 5});
  EXPECT_TRUE(all_finite(fine));
  EXPECT_TRUE(all_finite(MatrixX(0, 3)));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (Index i = 0; i < 2; ++i)
      for (Index j = 0; j < 3; ++j) {
        RealMatrix a = fine;
        a(i, j) = bad;
        EXPECT_FALSE(all_finite(a)) << i << ", " << j;
      }
}

TEST(DenseWhiteBox, CholeskyFactorsAndItsSolutions) {
  for (const Index n : sizes) {
    const RealMatrix a = positive(n, 1);
    const MatrixX right = random(n, 3, 2);
    MatrixX factor = a;
    ASSERT_TRUE(cholesky(factor));
    const RealMatrix l = lower_triangle(factor);
    EXPECT_LT(difference(l * l.transpose(), a), 1e-12 * a.largest()) << n;
    MatrixX solved = right;
    solve_lower(factor, solved);
    EXPECT_LT(difference(l * solved, right), 1e-12) << n;
    solved = right;
    solve_lower_transposed(factor, solved);
    EXPECT_LT(difference(l.transpose() * solved, right), 1e-12) << n;
    solved = right;
    solve_cholesky(factor, solved);
    EXPECT_LT(difference(a * solved, right), 1e-11) << n;
    EXPECT_LT(difference(a * inverse_from_cholesky(factor), RealMatrix::identity(n)), 1e-11) << n;
    MatrixX eliminated = a;
    VectorX unused = VectorX::Zero(n);
    EXPECT_NEAR(cholesky_log_determinant(factor), solve_general(eliminated, unused), 1e-9) << n;
  }
  MatrixX indefinite{{1, 0}, {2, 1}};  // lower triangle of eigenvalues 3 and -1
  EXPECT_FALSE(cholesky(indefinite));
  MatrixX large = positive(200, 1);
  large(199, 199) -= 1e3;
  EXPECT_FALSE(cholesky(large));
}

TEST(DenseWhiteBox, EliminationSolvesAndKnowsTheDeterminant) {
  MatrixX a{{0, 2, 0}, {0, 0, -3}, {5, 0, 0}};
  VectorX b = vector({2, 6, 20});
  EXPECT_NEAR(solve_general(a, b), std::log(30), 1e-15);
  EXPECT_LT((RealMatrix(b) - vector({4, 1, -2})).norm(), 1e-15);
  for (const Index n : sizes) {
    const RealMatrix matrix = random(n, n, 5), right = random(n, 1, 6);
    MatrixX in_place = matrix;
    VectorX solution = right;
    EXPECT_NEAR(solve_general(in_place, solution), std::log(std::abs(matrix.determinant())), 1e-9) << n;
    EXPECT_LT((matrix * solution - right).norm(), 1e-9) << n;
  }
}

// R'R = A'A, of more rows than columns and of fewer.
TEST(DenseWhiteBox, TriangularFactors) {
  for (const Index n : sizes)
    for (const Index rows : {n, n + 7, (n + 1) / 2}) {
      const RealMatrix a = random(rows, n, 7), r = triangular_factor(a);
      ASSERT_EQ(r.rows(), n);
      ASSERT_EQ(r.cols(), n);
      EXPECT_EQ(lower_triangle(r), RealMatrix::diagonal(r.diagonal()));
      EXPECT_LT(difference(r.transpose() * r, a.transpose() * a), 1e-12 * static_cast<double>(rows + 1)) << rows;
    }
}

// The residual is normal to the columns.
TEST(DenseWhiteBox, LeastSquaresByQr) {
  for (const Index n : sizes) {
    const RealMatrix a = random(2 * n + 3, n, 8), right = random(2 * n + 3, 2, 9);
    const QrSolution found = solve_by_qr(a, right);
    EXPECT_LT((a.transpose() * (a * found.solution - right)).largest(), 1e-11) << n;
    EXPECT_EQ(RealMatrix(found.triangle), RealMatrix(triangular_factor(a))) << n;
  }
}

/// A random symmetric matrix.
RealMatrix random_symmetric(Index n, std::uint64_t seed) {
  const RealMatrix half = random(n, n, seed);
  return half + half.transpose();
}

TEST(DenseWhiteBox, EigenvaluesOfSymmetricMatrices) {
  for (const Index n : sizes) {
    const RealMatrix a = random_symmetric(n, 10);
    const SymmetricEigen found = symmetric_eigen(lower_triangle(a));  // the upper one is not read
    ASSERT_TRUE(found.converged);
    const RealMatrix vectors = found.vectors;
    EXPECT_LT(difference(a * vectors, vectors * RealMatrix::diagonal(found.values)), 1e-12 * static_cast<double>(n));
    EXPECT_LT(difference(vectors.transpose() * vectors, RealMatrix::identity(n)), 1e-12);
    for (Index i = 1; i < n; ++i) EXPECT_LE(found.values(i - 1), found.values(i));
  }
  const RealMatrix of_two = symmetric_eigen(MatrixX{{2, 0}, {1, 2}}).values;
  EXPECT_LT((of_two - vector({1, 3})).norm(), 1e-15);
  EXPECT_FALSE(symmetric_eigen(MatrixX::Constant(3, 3, std::numeric_limits<double>::quiet_NaN())).converged);
}

TEST(DenseWhiteBox, TridiagonalForms) {
  for (const Index n : sizes) {
    const RealMatrix a = random_symmetric(n, 12);
    const TridiagonalForm form = tridiagonal_form(lower_triangle(a));
    ASSERT_EQ(form.subdiagonal.size(), n - 1);
    RealMatrix t = RealMatrix::diagonal(form.diagonal);
    for (Index i = 0; i + 1 < n; ++i) t(i, i + 1) = t(i + 1, i) = form.subdiagonal(i);
    const RealMatrix q = form.basis;
    EXPECT_LT(difference(q * t * q.transpose(), a), 1e-13 * static_cast<double>(n));
    EXPECT_LT(difference(q.transpose() * q, RealMatrix::identity(n)), 1e-13 * static_cast<double>(n));
  }
}

/// U S V'.
RealMatrix multiplied(const ThinSvd& svd) {
  return svd.u * RealMatrix::diagonal(svd.s) * RealMatrix(svd.v).transpose();
}

/// How far columns are from orthonormal: the largest difference of their products from 0, of each with itself from 1.
double from_orthonormal(const RealMatrix& columns) {
  return difference(columns.transpose() * columns, RealMatrix::identity(columns.cols()));
}

TEST(DenseWhiteBox, SingularValues) {
  for (const Index n : sizes)
    for (const Index rows : {n, n + 6}) {
      const RealMatrix a = random(rows, n, 11), wide = a.transpose();
      const ThinSvd tall = thin_svd(a), of_wide = thin_svd(wide);
      EXPECT_LT(difference(multiplied(tall), a), 1e-12 * static_cast<double>(n));
      EXPECT_LT(difference(multiplied(of_wide), wide), 1e-12 * static_cast<double>(n));
      EXPECT_LT(from_orthonormal(tall.u), 1e-12);
      EXPECT_LT(from_orthonormal(tall.v), 1e-12);
      EXPECT_LT(from_orthonormal(of_wide.v), 1e-12);
      const RightSingular right = right_singular(a);
      EXPECT_LT((RealMatrix(right.values) - tall.s).norm(), 1e-12 * tall.s(0));
      const RealMatrix images = a * right.vectors;
      for (Index i = 0; i < n; ++i)
        EXPECT_LT(std::abs(images.col(i).norm() - right.values(i)), 1e-12 * static_cast<double>(n));
      EXPECT_LT(from_orthonormal(right.vectors), 1e-12);
      for (Index i = 1; i < n; ++i) EXPECT_GE(tall.s(i - 1), tall.s(i));
    }
  const RealMatrix of_two = right_singular(MatrixX{{0, 3}, {-2, 0}, {0, 0}}).values;
  EXPECT_LT((of_two - vector({3, 2})).norm(), 1e-15);
}

}  // namespace
}  // namespace vernier::dense_test
