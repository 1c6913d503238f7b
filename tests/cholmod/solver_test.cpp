// CHOLMOD in place of Eigen for local states, against the dense solution of everything.

#include "vernier/cholmod/solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "local_states.hpp"

namespace vernier::cholmod_solver_test {
namespace {

using vernier_test::LocalStates;

TEST(CholmodSolver, StepsCovarianceAndDeterminantAreThoseOfTheDenseSystem) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const LocalStates problem(seed);
    const NormalEquations normal = problem.normal_equations();
    const FactorisedEquations solved(normal, problem.precisions, problem.steps, problem.local_steps, CholmodSolver{});
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

TEST(CholmodSolver, AMatrixThatIsNotPositiveDefiniteIsNotSolved) {
  // [1 2; 2 1] has the eigenvalues 3 and -1
  const SparseSymmetric matrix{2, {0, 2, 3}, {0, 1, 1}, {1, 2, 1}};
  MatrixX right = MatrixX::Identity(2, 2);
  EXPECT_FALSE(CholmodSolver{}(matrix, right).solved);
}

TEST(CholmodSolver, TwoByTwoByHand) {
  // [4 2; 2 3], determinant 8, inverse [3 -2; -2 4] / 8
  const SparseSymmetric matrix{2, {0, 2, 3}, {0, 1, 1}, {4, 2, 3}};
  MatrixX right = MatrixX::Identity(2, 2);
  const SparseOutcome outcome = CholmodSolver{}(matrix, right);
  ASSERT_TRUE(outcome.solved);
  EXPECT_NEAR(outcome.log_determinant, std::log(8.0), 1e-14);
  EXPECT_NEAR(right(0, 0), 3.0 / 8, 1e-15);
  EXPECT_NEAR(right(0, 1), -2.0 / 8, 1e-15);
  EXPECT_NEAR(right(1, 0), -2.0 / 8, 1e-15);
  EXPECT_NEAR(right(1, 1), 4.0 / 8, 1e-15);
}

}  // namespace
}  // namespace vernier::cholmod_solver_test
