// SPDX-License-Identifier: BSD-3-Clause
// Local states, eliminated by the Schur complement with the sparse solver of Eigen.

#include "vernier/least_squares/sparse_solve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sparse_solver_laws.hpp"

namespace vernier::local_states_test {
namespace {

constexpr EigenSparseSolver solver;

TEST(EigenSparseSolver, SolvesAsTheDenseSystemDoes) { vernier_test::expect_dense_solution(solver); }

TEST(EigenSparseSolver, TwoByTwoByHand) { vernier_test::expect_two_by_two(solver); }

// Little information is information: pivots far below one, of a matrix whose inverse is known.
TEST(EigenSparseSolver, SolvesInAnyUnit) {
  for (const double unit : {1e-9, 1e-3, 1e6}) {
    MatrixX right = MatrixX::Identity(2, 2);
    // [4 2; 2 3] has the determinant 8 and the inverse [3 -2; -2 4] / 8
    const SparseOutcome outcome = solver({2, {0, 2, 3}, {0, 1, 1}, {4 * unit, 2 * unit, 3 * unit}}, right);
    ASSERT_TRUE(outcome.solved);
    EXPECT_NEAR(outcome.log_determinant, std::log(8.0) + 2 * std::log(unit), 1e-12);
    EXPECT_NEAR(right(0, 0) * unit, 3.0 / 8, 1e-14);
    EXPECT_NEAR(right(1, 0) * unit, -2.0 / 8, 1e-14);
    EXPECT_NEAR(right(1, 1) * unit, 4.0 / 8, 1e-14);
  }
}

}  // namespace
}  // namespace vernier::local_states_test
