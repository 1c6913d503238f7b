// SPDX-License-Identifier: BSD-3-Clause
// Eigenvalues of few rows by hand.

#include "vernier/kinematics/detail/small_systems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "larger.hpp"
#include "vernier/core/types.hpp"
#include "vernier/kinematics/detail/reflections.hpp"

namespace vernier::small_systems_test {
namespace {

using namespace detail;

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
