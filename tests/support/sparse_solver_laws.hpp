// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// What every sparse solver must do, against dense solutions and by hand.

#include <gtest/gtest.h>

#include <cmath>

#include "local_states.hpp"

namespace vernier_test {

/// Steps, covariance and determinant are those of the dense system.
inline void expect_dense_solution(vernier::SparseSolve solve) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LocalStates problem(seed);
    const vernier::NormalEquations normal = problem.normal_equations();
    const vernier::FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps, solve);
    ASSERT_TRUE(solved.usable());
    const RealMatrix matrix = problem.matrix(), step = -matrix.solve(problem.gradient());
    constexpr Index n = LocalStates::dense;
    EXPECT_LT((solved.step() - step.block(0, 0, n, 1)).norm(), 1e-11 * step.norm());
    EXPECT_LT((solved.local_step() - step.block(n, 0, step.rows() - n, 1)).norm(), 1e-11 * step.norm());
    EXPECT_NEAR(solved.log_determinant(), matrix.log_determinant(), 1e-9);
    const RealMatrix covariance = matrix.inverse().block(0, 0, n, n);
    EXPECT_LT((solved.inverse() - covariance).norm(), 1e-11 * covariance.norm());
  }
}

/// [4 2; 2 3] has the determinant 8 and the inverse [3 -2; -2 4] / 8; [1 2; 2 1] has the eigenvalues 3 and -1.
inline void expect_two_by_two(vernier::SparseSolve solve) {
  MatrixX right = MatrixX::Identity(2, 2);
  const vernier::SparseOutcome outcome = solve({2, {0, 2, 3}, {0, 1, 1}, {4, 2, 3}}, right);
  ASSERT_TRUE(outcome.solved);
  EXPECT_NEAR(outcome.log_determinant, std::log(8.0), 1e-14);
  EXPECT_NEAR(right(0, 0), 3.0 / 8, 1e-15);
  EXPECT_NEAR(right(0, 1), -2.0 / 8, 1e-15);
  EXPECT_NEAR(right(1, 0), -2.0 / 8, 1e-15);
  EXPECT_NEAR(right(1, 1), 4.0 / 8, 1e-15);
  right.setIdentity();
  EXPECT_FALSE(solve({2, {0, 2, 3}, {0, 1, 1}, {1, 2, 1}}, right).solved);
}

}  // namespace vernier_test
