// Linear systems and eigenvalues of few rows, against matrices of run-time size and by hand.

#include "vernier/kinematics/detail/small_systems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "larger.hpp"
#include "real_matrix.hpp"
#include "vernier/core/rng.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/detail/reflections.hpp"

namespace vernier::small_systems_test {
namespace {

using namespace detail;
using vernier_test::RealMatrix;

MatrixX random(Index n, std::uint64_t seed) {
  Rng rng(seed);
  MatrixX out(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) out(i, j) = rng.uniform(-1, 1);
  return out;
}

TEST(SmallSystemsWhiteBox, ProductsAndSolutionsOfPositiveDefiniteSystems) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MatrixX values = random(6, seed);
    const RealMatrix a = values;
    const VectorX x = RealMatrix(random(6, seed + 100)).col(0);
    VectorX product(6);
    multiply_few<6, 6>(values.data(), x.data(), product.data());
    EXPECT_LT((RealMatrix(product) - a * x).norm(), 1e-14);
    EXPECT_NEAR(dot6(values.data(), x.data()), a.col(0).dot(x), 1e-14);
    const RealMatrix square = a * a.transpose() + RealMatrix::identity(6);
    MatrixX positive = square;
    VectorX solution = square * x;
    for (Index j = 0; j < 6; ++j)
      for (Index i = 0; i < j; ++i) positive(i, j) = 7;  // which is not read
    solve_few(positive.data(), solution.data(), 6);
    EXPECT_LT((RealMatrix(solution) - x).norm(), 1e-12);
  }
  const double good[] = {1, 2}, bad[] = {1, std::numeric_limits<double>::infinity()};
  EXPECT_TRUE(are_finite(good, 2));
  EXPECT_FALSE(are_finite(bad, 2));
}

TEST(SmallSystemsWhiteBox, InversesAndDeterminants) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MatrixX values = random(6, seed);
    const RealMatrix a = values;
    MatrixX inverse(6, 6);
    invert_few<6>(values.data(), inverse.data());
    const double condition = a.norm() * a.inverse().norm();
    EXPECT_LT((RealMatrix(inverse) * a - RealMatrix::identity(6)).norm(), 1e-14 * condition) << seed;
    double rows[6][6];
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) rows[j][i] = a(i, j);
    EXPECT_NEAR(determinant_few(rows), a.determinant(), 1e-13) << seed;
  }
  double swapped[2][2] = {{0, 3}, {2, 5}};  // one exchange of rows
  EXPECT_EQ(determinant_few(swapped), -6);
  double singular[2][2] = {{1, 2}, {2, 4}};
  EXPECT_EQ(determinant_few(singular), 0);
}

// The nearest of the expected eigenvalues that no other was matched with.
double largest_mismatch(const std::vector<std::complex<double>>& found, std::vector<std::complex<double>> expected) {
  double worst = 0;
  for (const auto& value : found) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < expected.size(); ++k)
      if (std::abs(expected[k] - value) < std::abs(expected[nearest] - value)) nearest = k;
    worst = vernier_test::larger(worst, std::abs(expected[nearest] - value));
    expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(nearest));
  }
  return worst;
}

std::vector<std::complex<double>> eigenvalues(MatrixX a) {
  std::vector<std::complex<double>> out(static_cast<std::size_t>(a.rows()));
  EXPECT_TRUE(hessenberg_eigenvalues(a.data(), static_cast<int>(a.rows()), out.data()));
  return out;
}

// n eigenvalues are determined by the traces of the first n powers, which are the sums of their powers. The
// determinant, their product, tells small ones more precisely.
TEST(SmallSystemsWhiteBox, EigenvaluesOfHessenbergMatrices) {
  for (const Index n : {1, 2, 3, 5, 8, 16})
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      MatrixX hessenberg = random(n, seed);
      for (Index j = 0; j < n; ++j)
        for (Index i = j + 1; i < n; ++i) hessenberg(i, j) = 0;
      const MatrixX below = random(n, seed + 50);
      for (Index k = 1; k < n; ++k) hessenberg(k, k - 1) = below(k, k - 1);
      const std::vector<std::complex<double>> found = eigenvalues(hessenberg);
      const RealMatrix a = hessenberg;
      RealMatrix power = RealMatrix::identity(n);
      for (Index k = 1; k <= n; ++k) {
        power = power * a;
        std::complex<double> sum = 0;
        double sizes = 0;
        for (const auto& value : found) {
          sum += std::pow(value, static_cast<int>(k));
          sizes += std::pow(std::abs(value), static_cast<int>(k));
        }
        EXPECT_LT(std::abs(sum - power.trace()), 1e-9 * sizes) << n << ' ' << seed << ' ' << k;
      }
      std::complex<double> product = 1;
      for (const auto& value : found) product *= value;
      EXPECT_LT(std::abs(product - a.determinant()), 1e-9 * std::abs(product)) << n << ' ' << seed;
    }
}

TEST(SmallSystemsWhiteBox, EigenvaluesByHand) {
  // companion matrix of (x - 1)(x - 2)(x - 3)(x^2 + 1) = x^5 - 6 x^4 + 12 x^3 - 12 x^2 + 11 x - 6
  MatrixX companion = MatrixX::Zero(5, 5);
  const double first_row[] = {6, -12, 12, -11, 6};
  for (Index k = 0; k < 5; ++k) companion(0, k) = first_row[k];
  for (Index k = 1; k < 5; ++k) companion(k, k - 1) = 1;
  EXPECT_LT(largest_mismatch(eigenvalues(companion), {1, 2, 3, {0, 1}, {0, -1}}), 1e-12);
  // a cyclic permutation, on which unshifted steps stand still: the fourth roots of one
  MatrixX cyclic = MatrixX::Zero(4, 4);
  for (Index k = 0; k < 4; ++k) cyclic((k + 1) % 4, k) = 1;
  EXPECT_LT(largest_mismatch(eigenvalues(cyclic), {1, -1, {0, 1}, {0, -1}}), 1e-14);
  MatrixX broken = MatrixX::Constant(3, 3, std::numeric_limits<double>::quiet_NaN());
  std::vector<std::complex<double>> out(3);
  EXPECT_FALSE(hessenberg_eigenvalues(broken.data(), 3, out.data()));
}

}  // namespace
}  // namespace vernier::small_systems_test
