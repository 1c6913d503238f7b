// Products and decompositions by their definitions, small and so large that kernels of wide instructions compute them.

#include "vernier/core/detail/dense.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/core/rng.hpp"

namespace vernier::dense_test {
namespace {

using namespace detail;

constexpr Index sizes[] = {1, 2, 5, 33, 200};

MatrixX random(Index rows, Index cols, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(rows, cols);
  for (double& value : out.reshaped()) value = rng.uniform(-1, 1);
  return out;
}

/// Positive definite, eigenvalues 1 and more.
MatrixX positive(Index n, std::uint64_t seed) {
  const MatrixX a = random(n, n, seed);
  return a * a.transpose() + MatrixX::Identity(n, n);
}

MatrixX lower(const MatrixX& a) { return a.triangularView<Eigen::Lower>(); }

double largest(const MatrixX& a) { return a.size() > 0 ? a.cwiseAbs().maxCoeff() : 0; }

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
  const MatrixX a{{1, 2}, {3, 4}, {5, 6}}, b{{1, 0, 2}, {-1, 3, 1}};
  EXPECT_EQ(product(a, Eigen::Vector2d(1, -2)), Vector3(-3, -5, -7));
  EXPECT_EQ(transposed_product(a, Vector3(1, 0, -1)), Eigen::Vector2d(-4, -4));
  EXPECT_EQ(matrix_product(a, b), (MatrixX{{-1, 6, 4}, {-1, 12, 10}, {-1, 18, 16}}));
  EXPECT_EQ(transposed_matrix_product(a, b.transpose()), (MatrixX{{11, 13}, {14, 16}}));
  EXPECT_EQ(rows_scaled(Vector3(2, 0, -1), a), (MatrixX{{2, 4}, {0, 0}, {-5, -6}}));
  EXPECT_EQ(columns_scaled(a, Eigen::Vector2d(2, -1)), (MatrixX{{2, -2}, {6, -4}, {10, -6}}));
  EXPECT_EQ(rows_minus(a, Eigen::Vector2d(1, 4)), (MatrixX{{0, -2}, {2, 0}, {4, 2}}));
  EXPECT_EQ(row_of(a, 1), Eigen::Vector2d(3, 4));
  EXPECT_EQ(rows_of(a, std::vector<Index>{2, 0, 2}), (MatrixX{{5, 6}, {1, 2}, {5, 6}}));
  EXPECT_EQ(diagonal_of(a), Eigen::Vector2d(1, 4));
  EXPECT_EQ(diagonal_of(b), Eigen::Vector2d(1, 3));
  EXPECT_EQ(column_means(a), Eigen::Vector2d(3, 4));
  EXPECT_EQ(squared_column_norms(a), Eigen::Vector2d(35, 56));
  EXPECT_EQ(squared_row_norms(a), Vector3(5, 25, 61));
  EXPECT_EQ(weighted_square(Vector3(1, 2, -3), Vector3(4, 5, 6)), -42);
  for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    MatrixX with_one = a;
    EXPECT_TRUE(all_finite(with_one));
    with_one(2, 1) = -bad;
    EXPECT_FALSE(all_finite(with_one));
  }
}

TEST(DenseWhiteBox, CholeskyFactorsAndItsSolutions) {
  for (const Index n : sizes) {
    const MatrixX a = positive(n, 1), right = random(n, 3, 2);
    MatrixX factor = a;
    ASSERT_TRUE(cholesky(factor));
    const MatrixX l = lower(factor);
    EXPECT_LT(largest(l * l.transpose() - a), 1e-12 * largest(a)) << n;
    MatrixX solved = right;
    solve_lower(factor, solved);
    EXPECT_LT(largest(l * solved - right), 1e-12) << n;
    solved = right;
    solve_lower_transposed(factor, solved);
    EXPECT_LT(largest(l.transpose() * solved - right), 1e-12) << n;
    solved = right;
    solve_cholesky(factor, solved);
    EXPECT_LT(largest(a * solved - right), 1e-11) << n;
    EXPECT_LT(largest(a * inverse_from_cholesky(factor) - MatrixX::Identity(n, n)), 1e-11) << n;
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
  VectorX b = Vector3(2, 6, 20);
  EXPECT_NEAR(solve_general(a, b), std::log(30), 1e-15);
  EXPECT_LT((b - Vector3(4, 1, -2)).norm(), 1e-15);
  for (const Index n : sizes) {
    const MatrixX matrix = random(n, n, 5);
    MatrixX in_place = matrix;
    const VectorX right = random(n, 1, 6);
    VectorX solution = right;
    EXPECT_NEAR(solve_general(in_place, solution), std::log(std::abs(matrix.determinant())), 1e-9) << n;
    EXPECT_LT((matrix * solution - right).norm(), 1e-9) << n;
  }
}

// R'R = A'A, of more rows than columns and of fewer.
TEST(DenseWhiteBox, TriangularFactors) {
  for (const Index n : sizes)
    for (const Index rows : {n, n + 7, (n + 1) / 2}) {
      const MatrixX a = random(rows, n, 7), r = triangular_factor(a);
      ASSERT_EQ(r.rows(), n);
      ASSERT_EQ(r.cols(), n);
      EXPECT_EQ(largest(r.triangularView<Eigen::StrictlyLower>().toDenseMatrix()), 0);
      EXPECT_LT(largest(r.transpose() * r - a.transpose() * a), 1e-12 * static_cast<double>(rows + 1)) << rows;
    }
}

// The residual is normal to the columns.
TEST(DenseWhiteBox, LeastSquaresByQr) {
  for (const Index n : sizes) {
    const MatrixX a = random(2 * n + 3, n, 8), right = random(2 * n + 3, 2, 9);
    const QrSolution found = solve_by_qr(a, right);
    EXPECT_LT(largest(a.transpose() * (a * found.solution - right)), 1e-11) << n;
    EXPECT_EQ(found.triangle, triangular_factor(a)) << n;
  }
}

TEST(DenseWhiteBox, EigenvaluesOfSymmetricMatrices) {
  for (const Index n : sizes) {
    MatrixX a = random(n, n, 10);
    a = (a + a.transpose()).eval();
    MatrixX given = a;
    given.triangularView<Eigen::StrictlyUpper>().setConstant(7);  // which is not read
    const SymmetricEigen found = symmetric_eigen(given);
    ASSERT_TRUE(found.converged);
    EXPECT_LT(largest(a * found.vectors - found.vectors * found.values.asDiagonal()), 1e-12 * static_cast<double>(n));
    EXPECT_LT(largest(found.vectors.transpose() * found.vectors - MatrixX::Identity(n, n)), 1e-12);
    for (Index i = 1; i < n; ++i) EXPECT_LE(found.values(i - 1), found.values(i));
  }
  EXPECT_LT((symmetric_eigen(MatrixX{{2, 0}, {1, 2}}).values - Eigen::Vector2d(1, 3)).norm(), 1e-15);
  EXPECT_FALSE(symmetric_eigen(MatrixX::Constant(3, 3, std::numeric_limits<double>::quiet_NaN())).converged);
}

TEST(DenseWhiteBox, SingularValues) {
  for (const Index n : sizes)
    for (const Index rows : {n, n + 6}) {
      const MatrixX a = random(rows, n, 11), wide = a.transpose();
      const ThinSvd tall = thin_svd(a), of_wide = thin_svd(wide);
      EXPECT_LT(largest(tall.u * tall.s.asDiagonal() * tall.v.transpose() - a), 1e-12 * static_cast<double>(n));
      EXPECT_LT(largest(of_wide.u * of_wide.s.asDiagonal() * of_wide.v.transpose() - wide),
                1e-12 * static_cast<double>(n));
      EXPECT_LT(largest(tall.u.transpose() * tall.u - MatrixX::Identity(n, n)), 1e-12);
      EXPECT_LT(largest(tall.v.transpose() * tall.v - MatrixX::Identity(n, n)), 1e-12);
      EXPECT_LT(largest(of_wide.v.transpose() * of_wide.v - MatrixX::Identity(n, n)), 1e-12);
      const RightSingular right = right_singular(a);
      EXPECT_LT((right.values - tall.s).norm(), 1e-12 * tall.s(0));
      EXPECT_LT(largest((a * right.vectors).colwise().norm().transpose() - right.values),
                1e-12 * static_cast<double>(n));
      EXPECT_LT(largest(right.vectors.transpose() * right.vectors - MatrixX::Identity(n, n)), 1e-12);
      for (Index i = 1; i < n; ++i) EXPECT_GE(tall.s(i - 1), tall.s(i));
    }
  EXPECT_LT((right_singular(MatrixX{{0, 3}, {-2, 0}, {0, 0}}).values - Eigen::Vector2d(3, 2)).norm(), 1e-15);
}

}  // namespace
}  // namespace vernier::dense_test
