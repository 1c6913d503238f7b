#pragma once

/// @file
/// What every sparse solver must do, against dense solutions and by hand.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
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
    const MatrixX matrix = problem.matrix();
    const Eigen::LLT<MatrixX> dense(matrix);
    const VectorX step = -dense.solve(problem.gradient());
    EXPECT_LT((solved.step() - step.head(LocalStates::dense)).norm(), 1e-11 * step.norm());
    EXPECT_LT((solved.local_step() - step.tail(solved.local_step().size())).norm(), 1e-11 * step.norm());
    const MatrixX factor = dense.matrixL();
    EXPECT_NEAR(solved.log_determinant(), 2 * factor.diagonal().array().log().sum(), 1e-9);
    const MatrixX covariance = MatrixX(matrix.inverse()).topLeftCorner(LocalStates::dense, LocalStates::dense);
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
